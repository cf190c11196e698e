#include "mesh/self_intersections.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "mesh/triangle_adjacency.hpp"
#include "mesh/vector3.hpp"
#include "parallel/radix_sort.hpp"

namespace octurn {
namespace {

using Corners = std::array<Vector3, 3>;

constexpr double least_gap = 1e-7;   // millimetres; coordinates are rounded to 1e-5
constexpr double least_sine = 1e-9;  // of angles that are told from none
constexpr double clear_sine = 1e-3;  // of angles that no rounding can hide

double square(double a) { return a * a; }

/// Whether all corners of two triangles lie on their own sides of a plane across `axis`.
bool is_apart_along(const Vector3& axis, const Corners& a, const Corners& b) {
  const std::array at_a{dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])};
  const std::array at_b{dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])};
  const auto [low_a, high_a] = std::ranges::minmax(at_a);
  const auto [low_b, high_b] = std::ranges::minmax(at_b);
  const double gap = std::max(low_b - high_a, low_a - high_b);
  return gap > 0 && square(gap) > square(least_gap) * dot(axis, axis);
}

/// For triangles without a common corner: one of these axes separates them, if any does
/// (Gottschalk, Lin and Manocha 1996).
bool disjoint(const Corners& a, const Corners& b) {
  const std::array sides_a{a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const std::array sides_b{b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vector3 normal_a = cross(sides_a[0], sides_a[1]);
  const Vector3 normal_b = cross(sides_b[0], sides_b[1]);
  if (is_apart_along(normal_a, a, b) || is_apart_along(normal_b, a, b)) {
    return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_apart_along(cross(normal_a, sides_a[i]), a, b) ||
        is_apart_along(cross(normal_b, sides_b[i]), a, b)) {
      return true;
    }
  }
  return std::ranges::any_of(sides_a, [&](const Vector3& side_a) {
    return std::ranges::any_of(sides_b, [&](const Vector3& side_b) {
      return is_apart_along(cross(side_a, side_b), a, b);
    });
  });
}

/// Two sides of a triangle from a corner, and their normal.
struct Sector {
  Vector3 first;
  Vector3 second;
  Vector3 normal = cross(first, second);

  /// Whether both sides of another leave its plane on the same side.
  bool same_side(const Sector& other) const {
    const double first_side = dot(normal, other.first);
    const double second_side = dot(normal, other.second);
    const double slack = square(least_sine) * dot(normal, normal);
    return (first_side > 0) == (second_side > 0) &&
           square(first_side) > slack * dot(other.first, other.first) &&
           square(second_side) > slack * dot(other.second, other.second);
  }

  /// Whether a direction in its plane lies between its sides, or on one.
  bool holds(const Vector3& direction) const {
    const double slack = square(least_sine) * dot(direction, direction) * dot(normal, normal);
    const double after_first = dot(cross(first, direction), normal);
    const double before_second = dot(cross(direction, second), normal);
    return (after_first >= 0 || square(after_first) < slack * dot(first, first)) &&
           (before_second >= 0 || square(before_second) < slack * dot(second, second));
  }
};

/// For triangles that have one corner in common: whether they meet nowhere else.
bool disjoint(const Sector& a, const Sector& b) {
  if (a.same_side(b) || b.same_side(a)) {
    return true;
  }
  const Vector3 meet = cross(a.normal, b.normal);
  if (dot(meet, meet) < square(least_sine) * dot(a.normal, a.normal) * dot(b.normal, b.normal)) {
    return !a.holds(b.first) && !a.holds(b.second) && !b.holds(a.first) && !b.holds(a.second);
  }
  const Vector3 other_way{-meet[0], -meet[1], -meet[2]};
  return !(a.holds(meet) && b.holds(meet)) && !(a.holds(other_way) && b.holds(other_way));
}

/// For triangles that have a side in common: whether one is not folded onto the other.
bool disjoint(const Vector3& side, const Vector3& to_a, const Vector3& to_b) {
  const Vector3 a = cross(side, to_a);
  const Vector3 b = cross(side, to_b);
  const Vector3 turn = cross(a, b);
  return dot(a, b) < 0 || dot(turn, turn) > square(least_sine) * dot(a, a) * dot(b, b);
}

/// Whether the triangles around a vertex lie side by side over a plane.
///
/// Over the plane across the sum of their normals, no triangle is turned over and each spoke is
/// left by the one triangle and met by the other: so they wind round the vertex, in full turns. If
/// that is one turn, they are sectors that do not overlap, and meet just in the spokes they share.
class Fan {
 public:
  Fan(std::span<const std::array<float, 3>> vertices, std::span<const MeshTriangle> triangles)
      : vertices_(vertices), triangles_(triangles), met_at_(vertices.size(), none) {
    corners_.assign(triangles, vertices.size());
  }

  bool is_flat(std::uint32_t vertex) {
    const std::span<const std::uint32_t> around = corners_.triangles_of(vertex);
    const Vector3 centre = vector_of(vertices_[vertex]);
    bool is_closed = !around.empty();
    Vector3 up{};
    wedges_.clear();
    for (const std::uint32_t i : around) {
      const auto [first, second] = spokes_of(i, vertex);
      is_closed = is_closed && met_at_[first] != vertex;
      met_at_[first] = vertex;
      wedges_.push_back({.first = vector_of(vertices_[first]) - centre,
                         .second = vector_of(vertices_[second]) - centre});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        up[axis] += wedges_.back().normal[axis];
      }
    }
    for (const std::uint32_t i : around) {
      std::uint32_t& met = met_at_[spokes_of(i, vertex).second];
      is_closed = is_closed && met == vertex;
      met = none;
    }
    return is_closed && turns(up) == 1;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  struct Spokes {
    std::uint32_t first;
    std::uint32_t second;
  };

  Spokes spokes_of(std::uint32_t triangle, std::uint32_t vertex) const {
    const MeshTriangle& corners = triangles_[triangle];
    const std::size_t at = local_index(corners, vertex);
    return {corners[(at + 1) % 3], corners[(at + 2) % 3]};
  }

  /// How often the wedges wind round the vertex, seen from `up`; 0 if one may be turned over.
  int turns(const Vector3& up) const {
    const Vector3 across = cross(up, wedges_.front().first);
    const double slack = square(clear_sine) * dot(up, up);
    int turns = 0;
    for (const Sector& wedge : wedges_) {
      const double above = dot(wedge.normal, up);
      const double sides = dot(wedge.first, wedge.first) * dot(wedge.second, wedge.second);
      if (!(above > 0 && square(above) > slack * sides)) {
        return 0;
      }
      turns += dot(across, wedge.first) < 0 && dot(across, wedge.second) >= 0 ? 1 : 0;
    }
    return turns;
  }

  std::span<const std::array<float, 3>> vertices_;
  std::span<const MeshTriangle> triangles_;
  TriangleAdjacency corners_ = {};
  std::vector<std::uint32_t> met_at_;  // by the other end of a spoke
  std::vector<Sector> wedges_ = {};
};

/// Four boxes; at first empty ones, which meet none.
struct Bvh4Node {
  static constexpr float far = std::numeric_limits<float>::max();
  std::array<Eigen::Array4f, 3> low{Eigen::Array4f::Constant(far), Eigen::Array4f::Constant(far),
                                    Eigen::Array4f::Constant(far)};
  std::array<Eigen::Array4f, 3> high{-low[0], -low[1], -low[2]};

  void set(std::size_t i, const Aabb& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis][static_cast<Eigen::Index>(i)] = box.low[axis];
      high[axis][static_cast<Eigen::Index>(i)] = box.high[axis];
    }
  }
  Aabb all() const {
    return {.low = {low[0].minCoeff(), low[1].minCoeff(), low[2].minCoeff()},
            .high = {high[0].maxCoeff(), high[1].maxCoeff(), high[2].maxCoeff()}};
  }
  /// How far they are from one of others, along the axis where that is most; not above 0 where
  /// they meet.
  Eigen::Array4f separation(const Bvh4Node& others, std::size_t i) const {
    const auto along = [&](std::size_t axis) -> Eigen::Array4f {
      const auto lane = static_cast<Eigen::Index>(i);
      return (low[axis] - others.high[axis][lane]).max(others.low[axis][lane] - high[axis]);
    };
    return along(0).max(along(1)).max(along(2));
  }
};

/// Looks at all pairs whose boxes meet, by a tree of boxes in which each has four others in it.
class Search {
 public:
  Search(std::span<const std::array<float, 3>> vertices, std::span<const MeshTriangle> triangles,
         std::size_t known)
      : vertices_(vertices), triangles_(triangles), known_(known) {
    sort();
    build();
    Fan fan(vertices, triangles);
    is_flat_.reserve(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
      is_flat_.push_back(fan.is_flat(i) ? 1 : 0);
    }
  }

  std::vector<Aabb> run() {
    if (!order_.empty()) {
      traverse_pair(levels_.size() - 1, 0, 0);
    }
    return std::move(cuts_);
  }

 private:
  Aabb bounds_of(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles_[triangle];
    Aabb bounds{.low = vertices_[a], .high = vertices_[a]};
    bounds.extend({vertices_[b], vertices_[b]});
    bounds.extend({vertices_[c], vertices_[c]});
    return bounds;
  }

  /// Along Morton's curve, which keeps together what is close.
  void sort() {
    constexpr int axis_bits = 10;
    Aabb all{.low = {Bvh4Node::far, Bvh4Node::far, Bvh4Node::far},
             .high = {-Bvh4Node::far, -Bvh4Node::far, -Bvh4Node::far}};
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      all.extend(bounds_of(i));
    }
    float side = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      side = std::max(side, all.high[axis] - all.low[axis]);
    }
    const float scale = side > 0 ? ((1 << axis_bits) - 1) / side : 0.0F;
    std::vector<KeyIndex> places;
    places.reserve(triangles_.size());
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const Aabb bounds = bounds_of(i);
      std::uint32_t key = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float middle = (bounds.low[axis] + bounds.high[axis]) / 2;
        key |= spread(static_cast<std::uint32_t>((middle - all.low[axis]) * scale)) << axis;
      }
      places.push_back({.key = key, .index = i});
    }
    radix_sort(places, 3 * axis_bits);
    order_.reserve(places.size());
    for (const KeyIndex& place : places) {
      order_.push_back(place.index);
    }
  }

  /// Ten bits, each to three times its place.
  static std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 16) & 0x030000ffU;
    bits = (bits | bits << 8) & 0x0300f00fU;
    bits = (bits | bits << 4) & 0x030c30c3U;
    return (bits | bits << 2) & 0x09249249U;
  }

  void build() {
    levels_.emplace_back((order_.size() + 3) / 4);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      levels_[0][i / 4].set(i % 4, bounds_of(order_[i]));
    }
    while (levels_.back().size() > 1) {
      const std::vector<Bvh4Node>& below = levels_.back();
      std::vector<Bvh4Node> level((below.size() + 3) / 4);
      for (std::size_t i = 0; i < below.size(); ++i) {
        level[i / 4].set(i % 4, below[i].all());
      }
      levels_.push_back(std::move(level));
    }
  }

  /// Looks at what lies in four boxes of a level with what lies in four others, or in the same.
  void traverse_pair(std::size_t level, std::size_t a, std::size_t b) {
    // What meets what follows no pattern: so no branches on that.
    std::array<std::array<std::size_t, 2>, 16> pairs;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Array4f gaps = levels_[level][b].separation(levels_[level][a], i);
      for (std::size_t j = 0; j < 4; ++j) {
        pairs[count] = {4 * a + i, 4 * b + j};
        count += gaps[static_cast<Eigen::Index>(j)] <= 0 && (a != b || i <= j) ? 1 : 0;
      }
    }
    for (const auto& [one, other] : std::span(pairs).first(count)) {
      if (level > 0) {
        traverse_pair(level - 1, one, other);
      } else if (one != other) {
        look_at(order_[one], order_[other]);
      }
    }
  }

  void look_at(std::uint32_t a, std::uint32_t b) {
    if (!share_star_shaped_fan(triangles_[a], triangles_[b]) && (a >= known_ || b >= known_) &&
        !disjoint(a, b)) {
      cuts_.push_back(bounds_of(a));
      cuts_.push_back(bounds_of(b));
    }
  }

  bool share_star_shaped_fan(const MeshTriangle& a, const MeshTriangle& b) const {
    int any = 0;
    for (const std::uint32_t corner : a) {
      const int is_common =
          (corner == b[0] ? 1 : 0) | (corner == b[1] ? 1 : 0) | (corner == b[2] ? 1 : 0);
      any |= is_common & is_flat_[corner];
    }
    return any != 0;
  }

  bool disjoint(std::uint32_t a, std::uint32_t b) const {
    // Corners that both have come first, in the order of the first.
    MeshTriangle one = triangles_[a];
    MeshTriangle other = triangles_[b];
    std::size_t common = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found =
          std::find(other.begin() + static_cast<std::ptrdiff_t>(common), other.end(), one[i]);
      if (found != other.end()) {
        std::swap(*found, other[common]);
        std::swap(one[i], one[common]);
        ++common;
      }
    }
    const Corners p = corners_of(one);
    const Corners q = corners_of(other);
    switch (common) {
      case 0:
        return octurn::disjoint(p, q);
      case 1:
        return octurn::disjoint(Sector{.first = p[1] - p[0], .second = p[2] - p[0]},
                                Sector{.first = q[1] - p[0], .second = q[2] - p[0]});
      case 2:
        return octurn::disjoint(p[1] - p[0], p[2] - p[0], q[2] - p[0]);
      default:
        return false;
    }
  }

  Corners corners_of(const MeshTriangle& triangle) const {
    return {vector_of(vertices_[triangle[0]]), vector_of(vertices_[triangle[1]]),
            vector_of(vertices_[triangle[2]])};
  }

  std::span<const std::array<float, 3>> vertices_;
  std::span<const MeshTriangle> triangles_;
  std::size_t known_;
  std::vector<std::uint32_t> order_ = {};
  std::vector<std::vector<Bvh4Node>> levels_ = {};  // the lowest, of the triangles, first
  std::vector<char> is_flat_ = {};                  // vertices
  std::vector<Aabb> cuts_ = {};
};

}  // namespace

std::vector<Aabb> self_intersections(std::span<const std::array<float, 3>> vertices,
                                     std::span<const MeshTriangle> triangles, std::size_t known) {
  return Search(vertices, triangles, known).run();
}

}  // namespace octurn
