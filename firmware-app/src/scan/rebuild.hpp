#pragma once

#include <filesystem>

#include "octurn/reconstruct.hpp"
#include "scan/command_slot.hpp"

namespace octurn {

/// Makes the model of a stored scan into a pipe, with no more memory than the options say and no
/// disk.
/// @param options  but for the clip box, which is the scan's
/// @throws Error  if the scan cannot be read, the model is empty or does not fit into memory;
///                Stopped
void make_model(const std::filesystem::path& folder, ReconstructOptions options, ModelPipe& pipe);

/// Carries a command out. Throws nothing: what goes wrong comes out of its pipe.
void rebuild(const RebuildCommand& command);

}  // namespace octurn
