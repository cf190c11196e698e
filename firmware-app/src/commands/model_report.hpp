#pragma once

#include <filesystem>
#include <string>

#include "octurn/quality.hpp"
#include "octurn/tiles.hpp"

namespace octurn {

/// Prints why a model is not good, as one line on standard error; nothing for a good one.
void print_verdict(const Quality& quality);

/// Prints on standard error that the depth images of a scan with free poses do not agree; nothing
/// if they do.
void print_agreement(const ViewAgreement& agreement);

/// Prints a line of JSON on standard output, or on standard error if the model is there.
/// @param model  where the model was written; "-" is standard output
void print_report(const std::filesystem::path& model, const std::string& json);

}  // namespace octurn
