#pragma once

#include <string>

#include "octurn/reconstruct.hpp"

namespace octurn {

/// A length in millimetres for people: "0.25 mm".
std::string mm_text(double metres);

/// The number of times that the root cube is halved down to the leaves, if the options that both
/// methods have are in their ranges.
/// @throws Error "bad-settings"  that says which option is out of its range
int checked_levels(const ReconstructOptions& options);

}  // namespace octurn
