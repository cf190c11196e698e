#pragma once

#include "octurn/reconstruct.hpp"

namespace octurn {

/// The number of times that the root cube is halved down to the leaves, if the options that both
/// methods have are in their ranges.
/// @throws Error "bad-settings"  that says which option is out of its range
int checked_levels(const ReconstructOptions& options);

}  // namespace octurn
