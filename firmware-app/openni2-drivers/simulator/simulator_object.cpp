#include "simulator/simulator_object.hpp"

#include <algorithm>
#include <cmath>

#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// Signed distances of solids and of their combinations, after Quilez, "Distance functions",
// https://iquilezles.org/articles/distfunctions. Everything below is in millimetres.

double sphere(const Vector3d& p, const Vector3d& centre, double radius) {
  return (p - centre).norm() - radius;
}

/// A line segment from `a` to `b`, thickened by `radius`.
double capsule(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d axis = b - a;
  const double along = std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - along * axis).norm() - radius;
}

/// `half` is from the centre to the faces; the edges are round with `radius`.
double box(const Vector3d& p, const Vector3d& centre, const Vector3d& half, double radius) {
  const Vector3d q = (p - centre).cwiseAbs() - half + Vector3d::Constant(radius);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

/// A disc across the X axis with round edges.
double disc(const Vector3d& p, const Vector3d& centre, double half_width, double rim,
            double radius) {
  const Vector3d r = p - centre;
  const Eigen::Vector2d q(std::hypot(r.y(), r.z()) - rim + radius,
                          std::abs(r.x()) - half_width + radius);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

/// The union of two solids, with a fillet about `width` wide along their seam. It is 1-Lipschitz as
/// the two are, because it is their minimum, or a blend of both less a constant.
double blend(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - h * h * width / 4;
}

/// The difference of two solids.
double carve(double solid, double hole) { return std::max(solid, -hole); }

double legs(const Vector3d& p) {
  const Vector3d mirrored(std::abs(p.x()), p.y(), p.z());  // left and right alike
  const double foot = box(mirrored, {19, -4, 7.5}, {14, 20, 7.5}, 3);
  const double shin = capsule(mirrored, {18, 0, 15}, {17, 0, 45}, 8);
  return blend(foot, shin, 5);
}

double body(const Vector3d& p) {
  const double trunk = box(p, {0, 0, 61}, {32, 22, 25}, 14);
  const double neck = capsule(p, {0, 0, 82}, {0, 0, 98}, 9);
  const double hollow = sphere(p, {0, -27, 62}, 16);
  return carve(blend(trunk, neck, 4), hollow);
}

double head(const Vector3d& p) {
  const Vector3d mirrored(std::abs(p.x()), p.y(), p.z());
  const double skull = box(p, {0, 0, 113}, {28, 22, 19}, 10);
  const double eye = sphere(mirrored, {12, -25, 117}, 8);
  const double ear = disc(mirrored, {29, 0, 113}, 4, 10, 2);
  const double aerial = capsule(p, {0, 4, 130}, {0, 4, 147}, 1.8);
  const double knob = sphere(p, {0, 4, 150}, 5.5);
  return std::min({carve(blend(skull, ear, 3), eye), aerial, knob});
}

double hanging_arm(const Vector3d& p) {
  const double upper = capsule(p, {-34, 0, 76}, {-49, -2, 58}, 6.5);
  const double lower = capsule(p, {-49, -2, 58}, {-47, -12, 38}, 6.5);
  const double hand = sphere(p, {-47, -13, 35}, 8.5);
  return blend(std::min(upper, lower), hand, 3);
}

double waving_arm(const Vector3d& p) {
  const double upper = capsule(p, {34, 0, 76}, {54, -2, 84}, 6.5);
  const double lower = capsule(p, {54, -2, 84}, {58, -8, 106}, 6.5);
  const double hand = sphere(p, {58, -9, 109}, 8.5);
  const double pole = capsule(p, {58, -10, 105}, {58, -10, 160}, 1.5);
  const double flag = box(p, {74.5, -10, 146}, {16.5, 1.2, 12}, 1.2);
  return std::min({blend(std::min(upper, lower), hand, 3), pole, flag});
}

}  // namespace

double simulator_object_distance(const Eigen::Vector3d& point) {
  const Vector3d p = point.unaryExpr(&mm_from_metres);
  const double trunk_and_limbs =
      blend(blend(body(p), legs(p), 5), std::min(hanging_arm(p), waving_arm(p)), 4);
  return metres_from_mm(std::min(trunk_and_limbs, head(p)));
}

Mesh simulator_object() {
  constexpr double cell = 0.00125;  // metres, about a pixel
  return surface_net(simulator_object_distance, simulator_object_bounds(), cell);
}

Eigen::AlignedBox3d simulator_object_bounds() {
  return {Vector3d(-60, -30, -1).unaryExpr(&metres_from_mm),
          Vector3d(93, 30, 164).unaryExpr(&metres_from_mm)};
}

namespace {

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
