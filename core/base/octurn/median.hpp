#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace octurn {

/// The median; of an even number of values the upper one of the middle two. 0 if there are none.
template <typename Number>
double median(std::vector<Number> values) {
  if (values.empty()) {
    return 0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace octurn
