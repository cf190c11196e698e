#pragma once

#include <filesystem>

#include "octurn/reconstruct.hpp"
#include "run/command_slot.hpp"

namespace octurn {

/// Makes the model of a stored scan and writes it into a pipe, within the options' memory limit and
/// without using the disk.
/// @param options  of the model; `clip` is replaced by the scan's
/// @throws Error  if the scan cannot be read, the model is empty or does not fit into memory;
///                Stopped
void make_model(const std::filesystem::path& folder, ReconstructOptions options, ModelPipe& pipe);

/// Executes a command. Throws nothing: errors are passed through the pipe.
void rebuild(const RebuildCommand& command);

}  // namespace octurn
