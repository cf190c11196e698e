#include "mesh_cuts.hpp"

#include <algorithm>
#include <numeric>

#include "vector3.hpp"

namespace octurn {
namespace {

using Corners = std::array<Vector3, 3>;

constexpr double least_gap = 1e-7;   // millimetres; coordinates are rounded to 1e-5
constexpr double least_sine = 1e-9;  // of angles that are told from none

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
bool are_apart(const Corners& a, const Corners& b) {
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
struct Wedge {
  Vector3 first;
  Vector3 second;
  Vector3 normal = cross(first, second);

  /// Whether both sides of another leave its plane on the same side.
  bool is_beside(const Wedge& other) const {
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
bool are_apart(const Wedge& a, const Wedge& b) {
  if (a.is_beside(b) || b.is_beside(a)) {
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
bool are_apart(const Vector3& side, const Vector3& to_a, const Vector3& to_b) {
  const Vector3 a = cross(side, to_a);
  const Vector3 b = cross(side, to_b);
  const Vector3 turn = cross(a, b);
  return dot(a, b) < 0 || dot(turn, turn) > square(least_sine) * dot(a, a) * dot(b, b);
}

/// Looks at all pairs whose boxes meet, by a tree of boxes in which each node halves its triangles.
class Search {
 public:
  Search(std::span<const std::array<float, 3>> vertices, std::span<const MeshTriangle> triangles,
         std::size_t known)
      : vertices_(vertices), triangles_(triangles), known_(known), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    bounds_.reserve(triangles.size());
    for (const MeshTriangle& triangle : triangles) {
      Bounds bounds{.low = vertices[triangle[0]], .high = vertices[triangle[0]]};
      bounds.extend({vertices[triangle[1]], vertices[triangle[1]]});
      bounds.extend({vertices[triangle[2]], vertices[triangle[2]]});
      bounds_.push_back(bounds);
    }
  }

  std::vector<Bounds> run() {
    if (!order_.empty()) {
      nodes_.reserve(2 * order_.size());
      nodes_.emplace_back();
      build(0, 0, static_cast<std::uint32_t>(order_.size()));
      look_within(0);
    }
    return std::move(cuts_);
  }

 private:
  static constexpr std::uint32_t few = 4;  // triangles in a leaf of the tree

  struct Node {
    Bounds bounds = {};
    std::uint32_t first = 0;  // in `order_`
    std::uint32_t end = 0;
    std::uint32_t children = 0;  // two nodes from here; 0: none
  };

  void build(std::uint32_t at, std::uint32_t first, std::uint32_t end) {
    Node node{.bounds = bounds_[order_[first]], .first = first, .end = end, .children = 0};
    for (std::uint32_t i = first + 1; i < end; ++i) {
      node.bounds.extend(bounds_[order_[i]]);
    }
    if (end - first > few) {
      std::size_t axis = 0;
      const auto extent = [&](std::size_t i) { return node.bounds.high[i] - node.bounds.low[i]; };
      for (const std::size_t i : {1U, 2U}) {
        axis = extent(i) > extent(axis) ? i : axis;
      }
      const std::uint32_t middle = first + (end - first) / 2;
      std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                       [&](std::uint32_t a, std::uint32_t b) {
                         return bounds_[a].low[axis] + bounds_[a].high[axis] <
                                bounds_[b].low[axis] + bounds_[b].high[axis];
                       });
      node.children = static_cast<std::uint32_t>(nodes_.size());
      nodes_.resize(nodes_.size() + 2);
      build(node.children, first, middle);
      build(node.children + 1, middle, end);
    }
    nodes_[at] = node;
  }

  void look_within(std::uint32_t at) {
    const Node& node = nodes_[at];
    if (node.children != 0) {
      look_within(node.children);
      look_within(node.children + 1);
      look_between(node.children, node.children + 1);
      return;
    }
    for (std::uint32_t i = node.first; i < node.end; ++i) {
      for (std::uint32_t j = i + 1; j < node.end; ++j) {
        look_at(order_[i], order_[j]);
      }
    }
  }

  void look_between(std::uint32_t a, std::uint32_t b) {
    const Node& one = nodes_[a];
    const Node& other = nodes_[b];
    if (!one.bounds.meets(other.bounds)) {
      return;
    }
    if (one.children == 0 && other.children == 0) {
      for (std::uint32_t i = one.first; i < one.end; ++i) {
        for (std::uint32_t j = other.first; j < other.end; ++j) {
          look_at(order_[i], order_[j]);
        }
      }
    } else if (other.children == 0 ||
               (one.children != 0 && one.end - one.first >= other.end - other.first)) {
      look_between(one.children, b);
      look_between(one.children + 1, b);
    } else {
      look_between(a, other.children);
      look_between(a, other.children + 1);
    }
  }

  void look_at(std::uint32_t a, std::uint32_t b) {
    if ((a >= known_ || b >= known_) && bounds_[a].meets(bounds_[b]) && !are_apart(a, b)) {
      cuts_.push_back(bounds_[a]);
      cuts_.push_back(bounds_[b]);
    }
  }

  bool are_apart(std::uint32_t a, std::uint32_t b) const {
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
        return octurn::are_apart(p, q);
      case 1:
        return octurn::are_apart(Wedge{.first = p[1] - p[0], .second = p[2] - p[0]},
                                 Wedge{.first = q[1] - p[0], .second = q[2] - p[0]});
      case 2:
        return octurn::are_apart(p[1] - p[0], p[2] - p[0], q[2] - p[0]);
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
  std::vector<std::uint32_t> order_;
  std::vector<Bounds> bounds_ = {};
  std::vector<Node> nodes_ = {};
  std::vector<Bounds> cuts_ = {};
};

}  // namespace

std::vector<Bounds> cuts_of(std::span<const std::array<float, 3>> vertices,
                            std::span<const MeshTriangle> triangles, std::size_t known) {
  return Search(vertices, triangles, known).run();
}

}  // namespace octurn
