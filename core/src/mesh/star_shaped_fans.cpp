#include "mesh/star_shaped_fans.hpp"

#include <limits>

#include "mesh/triangle_adjacency.hpp"
#include "mesh/triangle_overlap.hpp"

namespace octurn {
namespace {

constexpr double clear_sine = 1e-3;  // of angles that no rounding can hide
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The other ends of the two spokes between which a triangle lies.
struct Spokes {
  std::uint32_t first;
  std::uint32_t second;
};

Spokes find_spokes(const MeshTriangle& triangle, std::uint32_t centre) {
  const std::size_t at = local_index(triangle, centre);
  return {triangle[(at + 1) % 3], triangle[(at + 2) % 3]};
}

/// How often sectors wind round their vertex seen from `up`, counted where they cross a ray; 0 if
/// one may be turned over.
int winding_number(std::span<const Sector> sectors, const Vector3& up) {
  const Vector3 across = cross(up, sectors.front().first);
  const double slack = clear_sine * clear_sine * dot(up, up);
  int turns = 0;
  for (const Sector& sector : sectors) {
    const double above = dot(sector.normal, up);
    const double sides = dot(sector.first, sector.first) * dot(sector.second, sector.second);
    if (!(above > 0 && above * above > slack * sides)) {
      return 0;
    }
    turns += dot(across, sector.first) < 0 && dot(across, sector.second) >= 0 ? 1 : 0;
  }
  return turns;
}

/// Looks at the fans of single vertices, one after the other.
class FanCheck {
 public:
  FanCheck(std::span<const std::array<float, 3>> vertices, std::span<const MeshTriangle> triangles,
           const TriangleAdjacency& adjacency)
      : vertices_(vertices),
        triangles_(triangles),
        adjacency_(adjacency),
        left_from_(vertices.size(), none) {}

  bool is_star_shaped(std::uint32_t vertex) {
    const std::span<const std::uint32_t> fan = adjacency_.triangles_at(vertex);
    const Vector3 centre = to_vector3(vertices_[vertex]);
    bool is_closed = !fan.empty();
    Vector3 up{};
    sectors_.clear();
    for (const std::uint32_t i : fan) {
      const auto [first, second] = find_spokes(triangles_[i], vertex);
      is_closed = is_closed && left_from_[first] != vertex;
      left_from_[first] = vertex;
      sectors_.push_back({.first = to_vector3(vertices_[first]) - centre,
                          .second = to_vector3(vertices_[second]) - centre});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        up[axis] += sectors_.back().normal[axis];
      }
    }
    for (const std::uint32_t i : fan) {
      std::uint32_t& left = left_from_[find_spokes(triangles_[i], vertex).second];
      is_closed = is_closed && left == vertex;
      left = none;
    }
    return is_closed && winding_number(sectors_, up) == 1;
  }

 private:
  std::span<const std::array<float, 3>> vertices_;
  std::span<const MeshTriangle> triangles_;
  const TriangleAdjacency& adjacency_;
  std::vector<std::uint32_t> left_from_;  // by spoke's end: the centre
  std::vector<Sector> sectors_ = {};
};

}  // namespace

std::vector<char> find_star_shaped_fans(std::span<const std::array<float, 3>> vertices,
                                        std::span<const MeshTriangle> triangles, ThreadTeam& team) {
  const TriangleAdjacency adjacency(triangles, vertices.size(), team);
  std::vector<char> is_star_shaped(vertices.size(), 0);
  team.run([&](int thread) {
    FanCheck check(vertices, triangles, adjacency);
    const auto [first, end] = team.share(vertices.size(), thread);
    for (std::size_t vertex = first; vertex < end; ++vertex) {
      is_star_shaped[vertex] = check.is_star_shaped(static_cast<std::uint32_t>(vertex)) ? 1 : 0;
    }
  });
  return is_star_shaped;
}

}  // namespace octurn
