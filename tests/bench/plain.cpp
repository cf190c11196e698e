#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <unordered_set>
#include <vector>

#include "bennett/triangulate.hpp"
#include "bennett/voxelize_triangle.hpp"
#include "depth/back_project.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"

// A direct implementation of Bennett 2014, for `compare`: nodes that point to their eight children,
// every triangle tested from the root down by separating axes, a hash set of pseudo-voxels, one
// thread. It reads scans and rounds corners like the library, so it must give as many triangles;
// everything else is independent.
//
//   plain SCAN_DIR OUTPUT.stl LEAF_MM

namespace octurn {
namespace {

using Vector = std::array<std::int64_t, 3>;

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::int64_t dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A triangle, and the thirteen axes that may separate it from a box (Akenine-Moller 2001).
struct Triangle {
  std::array<Vector, 3> corners = {};
  std::array<Vector, 13> axes = {};
  std::array<std::int64_t, 13> low = {};
  std::array<std::int64_t, 13> high = {};

  explicit Triangle(const std::array<Vector, 3>& points) : corners(points) {
    const std::array<Vector, 3> unit{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::size_t count = 0;
    for (const Vector& axis : unit) {
      axes[count++] = axis;
    }
    axes[count++] = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Vector& axis : unit) {
        axes[count++] = cross(axis, minus(corners[(i + 1) % 3], corners[i]));
      }
    }
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const auto [least, most] = std::minmax(
          {dot(axes[i], corners[0]), dot(axes[i], corners[1]), dot(axes[i], corners[2])});
      low[i] = least;
      high[i] = most;
    }
  }

  bool meets(const Vector& corner, std::int64_t side) const {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Vector& axis = axes[i];
      const std::int64_t at = dot(axis, corner);
      const auto reach = [&](bool up) {
        std::int64_t sum = 0;
        for (const std::int64_t along : axis) {
          sum += (along > 0) == up ? along * side : 0;
        }
        return at + sum;
      };
      if (reach(true) < low[i] || reach(false) > high[i]) {
        return false;
      }
    }
    return true;
  }
};

struct Node {
  std::array<std::unique_ptr<Node>, 8> children = {};
};

class PlainOctree {
 public:
  explicit PlainOctree(int levels) : levels_(levels) {}

  int side() const { return 1 << levels_; }

  void add(const Triangle& triangle) {
    if (triangle.meets({0, 0, 0}, std::int64_t{1} << SnapGrid::bits)) {
      add(root_, triangle, {0, 0, 0}, 0);
    }
  }

  bool has_leaf(const std::array<int, 3>& at) const {
    const Node* node = &root_;
    for (int bit = levels_ - 1; bit >= 0 && node != nullptr; --bit) {
      node = node->children[static_cast<std::size_t>((at[0] >> bit & 1) | (at[1] >> bit & 1) << 1 |
                                                     (at[2] >> bit & 1) << 2)]
                 .get();
    }
    return node != nullptr;
  }

  template <typename Visit>
  void for_each_leaf(Visit visit) const {
    for_each_leaf(root_, {0, 0, 0}, 0, visit);
  }

 private:
  void add(Node& node, const Triangle& triangle, const Vector& corner, int level) {
    if (level == levels_) {
      return;
    }
    const std::int64_t half = std::int64_t{1} << (SnapGrid::bits - level - 1);
    for (int i = 0; i < 8; ++i) {
      const Vector below{corner[0] + (i & 1) * half, corner[1] + (i >> 1 & 1) * half,
                         corner[2] + (i >> 2) * half};
      if (triangle.meets(below, half)) {
        auto& child = node.children[static_cast<std::size_t>(i)];
        if (!child) {
          child = std::make_unique<Node>();
        }
        add(*child, triangle, below, level + 1);
      }
    }
  }

  template <typename Visit>
  void for_each_leaf(const Node& node, const std::array<int, 3>& at, int level,
                     Visit& visit) const {
    if (level == levels_) {
      visit(at);
      return;
    }
    for (int i = 0; i < 8; ++i) {
      if (const auto& child = node.children[static_cast<std::size_t>(i)]) {
        for_each_leaf(*child, {2 * at[0] + (i & 1), 2 * at[1] + (i >> 1 & 1), 2 * at[2] + (i >> 2)},
                      level + 1, visit);
      }
    }
  }

  int levels_;
  Node root_ = {};
};

/// Marching tetrahedra on the pseudo-voxels around every leaf, each visited once.
class PlainSurface {
 public:
  PlainSurface(const PlainOctree& octree, const std::string& file)
      : octree_(octree), file_(file), half_leaf_mm_(500.0 / octree.side()) {
    octree.for_each_leaf([&](const std::array<int, 3>& leaf) {
      for (int i = 0; i < 8; ++i) {
        visit({leaf[0] - (i & 1), leaf[1] - (i >> 1 & 1), leaf[2] - (i >> 2)});
      }
    });
    file_.commit();
  }

  std::uint64_t facets() const { return facets_; }

 private:
  static std::array<int, 3> corner(const std::array<int, 3>& low, int i) {
    return {low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2)};
  }

  bool is_in(const std::array<int, 3>& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < octree_.side() &&
           at[1] < octree_.side() && at[2] < octree_.side() && octree_.has_leaf(at);
  }

  void visit(const std::array<int, 3>& low) {
    const auto part = [&](std::size_t axis) { return static_cast<std::uint64_t>(low[axis] + 1); };
    if (!visited_.insert(part(0) | part(1) << 20U | part(2) << 40U).second) {
      return;
    }
    constexpr std::array<std::array<int, 4>, 6> tetrahedra{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    std::array<bool, 8> in{};
    for (int i = 0; i < 8; ++i) {
      in[static_cast<std::size_t>(i)] = is_in(corner(low, i));
    }
    for (const auto& tetrahedron : tetrahedra) {
      march(low, tetrahedron, in);
    }
  }

  void march(const std::array<int, 3>& low, const std::array<int, 4>& tetrahedron,
             const std::array<bool, 8>& in) {
    std::vector<int> inside;
    std::vector<int> outside;
    for (const int i : tetrahedron) {
      (in[static_cast<std::size_t>(i)] ? inside : outside).push_back(i);
    }
    const auto middle = [&](int a, int b) {
      const auto p = corner(low, a);
      const auto q = corner(low, b);
      return Vector{p[0] + q[0] + 1, p[1] + q[1] + 1, p[2] + q[2] + 1};  // half leaves
    };
    const auto between = [&](std::size_t i, std::size_t o) {
      return middle(inside[i], outside[o]);
    };
    if (inside.size() == 1) {
      add(between(0, 0), between(0, 1), between(0, 2), middle(inside[0], inside[0]));
    } else if (inside.size() == 2) {
      add(between(0, 0), between(0, 1), between(1, 1), middle(inside[0], inside[0]));
      add(between(0, 0), between(1, 1), between(1, 0), middle(inside[1], inside[1]));
    } else if (inside.size() == 3) {
      add(between(0, 0), between(1, 0), between(2, 0), middle(inside[0], inside[0]));
    }
  }

  /// @param behind  a point behind the facet
  void add(const Vector& a, const Vector& b, const Vector& c, const Vector& behind) {
    const Vector normal = cross(minus(b, a), minus(c, a));
    const bool outward = dot(normal, minus(a, behind)) > 0;
    Facet facet;
    std::array<std::array<float, 3>, 3> corners{};
    std::size_t next = 0;
    for (const Vector& point : outward ? std::array{a, b, c} : std::array{a, c, b}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corners[next][axis] = static_cast<float>(static_cast<double>(point[axis]) * half_leaf_mm_ -
                                                 (axis < 2 ? 500.0 : 0.0));
      }
      ++next;
    }
    facet.corners = corners;
    file_.write({&facet, 1});
    ++facets_;
  }

  const PlainOctree& octree_;
  StlFile file_;
  double half_leaf_mm_;
  std::unordered_set<std::uint64_t> visited_ = {};
  std::uint64_t facets_ = 0;
};

std::uint64_t run(const std::string& folder, const std::string& output, double leaf_size) {
  const Scan scan = read_scan(folder);
  const SnapGrid snap_grid(1.0);
  PlainOctree octree(Octree::level_for(1.0, leaf_size));
  for (const Shot& shot : scan.shots) {
    PointGrid grid = world_points(read_snapshot(folder, scan, shot));
    clip(grid, scan.clip);
    triangulate(grid, 0.0001F,
                [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
                  std::array<Vector, 3> corners{};
                  std::size_t next = 0;
                  for (const Eigen::Vector3f& point : {a, b, c}) {
                    const auto nearest = snap_grid.snap(point);
                    corners[next++] = {(*nearest)[0], (*nearest)[1], (*nearest)[2]};
                  }
                  octree.add(Triangle(corners));
                });
  }
  return PlainSurface(octree, output).facets();
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s SCAN_DIR OUTPUT.stl LEAF_MM\n", argv[0]);
    return 2;
  }
  try {
    const double leaf_size = octurn::metres_from_mm(std::strtod(argv[3], nullptr));
    const std::uint64_t facets = octurn::run(argv[1], argv[2], leaf_size);
    std::printf("%llu\n", static_cast<unsigned long long>(facets));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "plain: %s\n", error.what());
    return 1;
  }
  return 0;
}
