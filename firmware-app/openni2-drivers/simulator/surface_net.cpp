#include "simulator/surface_net.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// The signed distance at the corners of a lattice of cells. In a block of cells without surface
/// all corners hold the distance at the block's centre, which has the right sign.
class Lattice {
 public:
  Lattice(const SignedDistance& distance, const Eigen::AlignedBox3d& bounds, double cell)
      : distance_(distance), origin_(bounds.min() - Vector3d::Constant(cell)), cell_(cell) {
    size_ =
        (bounds.sizes() / cell).array().ceil().cast<int>() + 3;  // one cell of margin on each side
    values_.resize(static_cast<std::size_t>(size_.prod()));
    fill(Vector3i::Zero(), size_);
  }

  const Vector3i& size() const { return size_; }
  Vector3d point(const Vector3d& at) const { return origin_ + cell_ * at; }
  std::size_t index(const Vector3i& at) const {
    return (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(at.x());
  }
  float operator()(const Vector3i& at) const { return values_[index(at)]; }

  /// A corner as far from the surface as this belongs to no cell that the surface crosses.
  float beyond_a_cell() const { return static_cast<float>(2 * cell_); }

 private:
  /// Fills the corners from `min` up to but not including `max`, halving the longest side.
  void fill(const Vector3i& min, const Vector3i& max) {
    const Vector3d middle = (min + max - Vector3i::Ones()).cast<double>() / 2;
    const double value = distance_(point(middle));
    const double reach = ((max - min).cast<double>().norm() / 2 + 1) * cell_;
    int axis = 0;
    const int longest = (max - min).maxCoeff(&axis);
    if (longest == 1 || std::abs(value) > reach) {
      set(min, max, static_cast<float>(value));
      return;
    }
    Vector3i half = max;
    half[axis] = min[axis] + longest / 2;
    fill(min, half);
    half = min;
    half[axis] = min[axis] + longest / 2;
    fill(half, max);
  }

  void set(const Vector3i& min, const Vector3i& max, float value) {
    for (int z = min.z(); z < max.z(); ++z) {
      for (int y = min.y(); y < max.y(); ++y) {
        std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(index({min.x(), y, z})),
                    max.x() - min.x(), value);
      }
    }
  }

  const SignedDistance& distance_;
  Vector3d origin_;
  double cell_;
  Vector3i size_;
  std::vector<float> values_;
};

/// @param value  the distance at the point
Vector3d gradient(const SignedDistance& distance, const Vector3d& at, double value, double step) {
  Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = (distance(at + step * Vector3d::Unit(axis)) - value) / step;
  }
  return result;
}

/// Moves a point onto the surface by Newton steps along the gradient, each at most a cell long,
/// until it is within a 100,000th of a cell.
Vector3d onto_surface(const SignedDistance& distance, Vector3d at, double cell) {
  constexpr int max_steps = 4;
  double value = distance(at);
  for (int i = 0; i < max_steps && std::abs(value) > cell / 100'000; ++i) {
    const Vector3d slope = gradient(distance, at, value, cell / 100);
    at -= slope * (std::clamp(value, -cell, cell) / std::max(slope.squaredNorm(), 0.25));
    value = distance(at);
  }
  return at;
}

/// Computes the mean of the points where the surface crosses the edges of a cell, in cells.
/// @return false if it crosses none
bool crossing_of(const Lattice& lattice, const Vector3i& cell, Vector3d& mean) {
  if (std::abs(lattice(cell)) > lattice.beyond_a_cell()) {
    return false;
  }
  Vector3d sum = Vector3d::Zero();
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      Vector3i from = cell;
      from[(axis + 1) % 3] += edge & 1;
      from[(axis + 2) % 3] += edge >> 1;
      const float a = lattice(from);
      const float b = lattice(from + Vector3i::Unit(axis));
      if ((a < 0) != (b < 0)) {
        sum += from.cast<double>() + static_cast<double>(a / (a - b)) * Vector3d::Unit(axis);
        ++crossings;
      }
    }
  }
  mean = sum / std::max(crossings, 1);
  return crossings > 0;
}

template <typename Visit>
void for_each(const Vector3i& min, const Vector3i& max, const Visit& visit) {
  for (int z = min.z(); z < max.z(); ++z) {
    for (int y = min.y(); y < max.y(); ++y) {
      for (int x = min.x(); x < max.x(); ++x) {
        visit(Vector3i(x, y, z));
      }
    }
  }
}

}  // namespace

Mesh surface_net(const SignedDistance& distance, const Eigen::AlignedBox3d& bounds, double cell) {
  const Lattice lattice(distance, bounds, cell);
  Mesh mesh;
  std::vector<std::uint32_t> vertex_of(static_cast<std::size_t>(lattice.size().prod()));
  for_each(Vector3i::Zero(), lattice.size() - Vector3i::Ones(), [&](const Vector3i& at) {
    Vector3d mean;
    if (crossing_of(lattice, at, mean)) {
      vertex_of[lattice.index(at)] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.emplace_back(onto_surface(distance, lattice.point(mean), cell).cast<float>());
    }
  });
  for_each(Vector3i::Ones(), lattice.size() - Vector3i::Ones(), [&](const Vector3i& at) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool inside = lattice(at) < 0;
      if (inside == (lattice(at + Vector3i::Unit(axis)) < 0)) {
        continue;
      }
      const Vector3i back = Vector3i::Unit((axis + 1) % 3);
      const Vector3i down = Vector3i::Unit((axis + 2) % 3);
      const std::uint32_t a = vertex_of[lattice.index(at - back - down)];
      std::uint32_t b = vertex_of[lattice.index(at - down)];
      const std::uint32_t c = vertex_of[lattice.index(at)];
      std::uint32_t d = vertex_of[lattice.index(at - back)];
      if (!inside) {
        std::swap(b, d);  // so that the corners turn counter-clockwise seen from outside
      }
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  });
  return mesh;
}

}  // namespace octurn
