#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// A candidate edge collapse. The new vertex's position is not stored, as the list is long: it is
/// computed again from the quadrics of both ends when the edge is collapsed.
struct Collapse {
  double cost = 0;  ///< mean square distance, mm^2
  std::uint32_t kept = 0;
  std::uint32_t removed = 0;
};

/// Sorts by cost and removes duplicates. Equal costs are sorted by vertex index, so that the result
/// does not depend on the order before.
void sort_by_cost(std::vector<Collapse>& collapses);

}  // namespace octurn
