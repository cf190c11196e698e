#include "simulator/simulator_object.hpp"

#include <algorithm>
#include <cmath>

#include "octurn/units.hpp"
#include "simulator/surface_net.hpp"

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

}  // namespace octurn
