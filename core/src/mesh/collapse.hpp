#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// An edge collapse that could be made. Where to is found anew from the quadrics of both ends, when
/// it is made: a list of a window's collapses is long.
struct Collapse {
  double cost = 0;  ///< mean square distance, mm^2
  std::uint32_t kept = 0;
  std::uint32_t removed = 0;
};

/// The cheapest first, without those that come twice. Of equal cost that of the lower vertices:
/// the order does not depend on that before.
void sort_by_cost(std::vector<Collapse>& collapses);

}  // namespace octurn
