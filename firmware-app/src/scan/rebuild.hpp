#pragma once

#include "scan/command_slot.hpp"

namespace octurn {

/// Makes the model of a stored scan into the command's pipe, with no more memory than the options
/// say and no disk. Throws nothing: what goes wrong comes out of the pipe.
void rebuild(const RebuildCommand& command);

}  // namespace octurn
