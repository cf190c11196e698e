#include "mesh/quadric.hpp"

namespace octurn {
namespace {

/// Weight of the squared distance to the guess, as a share of the planes' weight: small beside
/// them, large beside rounding (Tikhonov regularisation).
constexpr double regularisation = 1e-3;

/// The regularised normal equations, (A + r I) p = r guess - b.
struct NormalEquations {
  double xx, yy, zz;  // of the matrix's diagonal; the rest is A's
  Vector3 right;
};

NormalEquations make_normal_equations(const Quadric& quadric, const Vector3& guess) {
  const auto& [xx, xy, xz, yy, yz, zz, x, y, z, c] = quadric.terms;
  const double weight = regularisation * quadric.area;
  return {.xx = xx + weight,
          .yy = yy + weight,
          .zz = zz + weight,
          .right = {weight * guess[0] - x, weight * guess[1] - y, weight * guess[2] - z}};
}

}  // namespace

Vector3 Quadric::optimum(const Vector3& guess) const {
  const double xy = terms[1];
  const double xz = terms[2];
  const double yz = terms[4];
  const auto [xx, yy, zz, right] = make_normal_equations(*this, guess);
  // Cramer's rule, by the cofactors of the symmetric matrix.
  const double cofactor_xx = yy * zz - yz * yz;
  const double cofactor_xy = xz * yz - xy * zz;
  const double cofactor_xz = xy * yz - xz * yy;
  const double cofactor_yy = xx * zz - xz * xz;
  const double cofactor_yz = xy * xz - xx * yz;
  const double cofactor_zz = xx * yy - xy * xy;
  const double determinant = xx * cofactor_xx + xy * cofactor_xy + xz * cofactor_xz;
  return {(right[0] * cofactor_xx + right[1] * cofactor_xy + right[2] * cofactor_xz) / determinant,
          (right[0] * cofactor_xy + right[1] * cofactor_yy + right[2] * cofactor_yz) / determinant,
          (right[0] * cofactor_xz + right[1] * cofactor_yz + right[2] * cofactor_zz) / determinant};
}

Vector3 Quadric::optimum_on_platform(const Vector3& guess) const {
  const double xy = terms[1];
  const auto [xx, yy, zz, right] = make_normal_equations(*this, guess);
  const double determinant = xx * yy - xy * xy;
  return {(right[0] * yy - right[1] * xy) / determinant,
          (right[1] * xx - right[0] * xy) / determinant, 0.0};
}

Quadric plane_quadric(const Vector3& normal, double offset, double area) {
  const auto& [x, y, z] = normal;
  return {.terms = {area * (x * x), area * (x * y), area * (x * z), area * (y * y), area * (y * z),
                    area * (z * z), area * (x * offset), area * (y * offset), area * (z * offset),
                    area * (offset * offset)},
          .area = area};
}

}  // namespace octurn
