#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace octurn {

/// An edge collapse that could be made.
struct Collapse {
  double cost = 0;  ///< mean square distance, mm^2
  std::uint32_t kept = 0;
  std::uint32_t removed = 0;
  std::array<float, 3> position = {};  ///< of the vertex that is kept
};

/// The cheapest first, without those that come twice. Of equal cost that of the lower vertices:
/// the order does not depend on that before.
void sort_by_cost(std::vector<Collapse>& collapses);

}  // namespace octurn
