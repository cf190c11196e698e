#pragma once

#include "octurn/reconstruct.hpp"

namespace octurn {

/// Checks the options that both methods have, and returns the leaves' level.
/// @throws Error "bad-settings"  that names the option that is out of range
int checked_levels(const ReconstructOptions& options);

}  // namespace octurn
