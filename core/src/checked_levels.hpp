#pragma once

#include "octurn/reconstruct.hpp"

namespace octurn {

/// The number of levels that the options ask for, if what all methods need is in its range.
/// @throws Error "bad-settings"  that says which option is out of its range
int checked_levels(const ReconstructOptions& options);

}  // namespace octurn
