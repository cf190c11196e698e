#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace octurn {

/// The number of triangles of a binary STL, or -1 if its size does not match that number.
inline std::int64_t triangles_of_whole_stl(std::string_view stl) {
  std::uint32_t count = 0;
  if (stl.size() < 84) {
    return -1;
  }
  std::memcpy(&count, stl.data() + 80, sizeof count);
  return stl.size() == 84 + std::size_t{50} * count ? std::int64_t{count} : -1;
}

/// Counts the directed edges of a binary STL that are not balanced by as many opposite ones.
/// Corners are compared bit by bit; 0 means a closed surface.
inline int open_edges(std::string_view stl) {
  std::map<std::pair<std::string_view, std::string_view>, int> balance;
  for (std::size_t facet = 84; facet + 50 <= stl.size(); facet += 50) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::string_view from = stl.substr(facet + 12 + 12 * corner, 12);
      const std::string_view to = stl.substr(facet + 12 + 12 * ((corner + 1) % 3), 12);
      from < to ? ++balance[{from, to}] : --balance[{to, from}];
    }
  }
  int open = 0;
  for (const auto& [edge, sum] : balance) {
    open += sum != 0 ? 1 : 0;
  }
  return open;
}

}  // namespace octurn
