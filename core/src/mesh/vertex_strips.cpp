#include "mesh/vertex_strips.hpp"

#include <algorithm>

namespace octurn {
namespace {

constexpr std::size_t sampling = 16;  // vertices for each whose place counts

/// The coordinates between the strips.
std::vector<float> find_borders(std::span<const MeshVertex> vertices, std::size_t axis, int count) {
  std::vector<float> places;
  for (std::size_t i = 0; i < vertices.size(); i += sampling) {
    places.push_back(vertices[i].position[axis]);
  }
  std::ranges::sort(places);
  std::vector<float> borders;
  for (int strip = 1; strip < count && !places.empty(); ++strip) {
    borders.push_back(
        places[places.size() * static_cast<std::size_t>(strip) / static_cast<std::size_t>(count)]);
  }
  return borders;
}

}  // namespace

VertexStrips make_strips(std::span<const MeshVertex> vertices, std::size_t axis, int count,
                         ThreadTeam& team) {
  const std::vector<float> borders = find_borders(vertices, axis, count);
  VertexStrips strips(vertices.size());
  team.run([&](int thread) {
    const auto [first, end] = team.share(vertices.size(), thread);
    for (std::size_t i = first; i < end; ++i) {
      const float place = vertices[i].position[axis];
      strips[i] = static_cast<std::uint16_t>(
          std::ranges::count_if(borders, [&](float border) { return border <= place; }));
    }
  });
  return strips;
}

}  // namespace octurn
