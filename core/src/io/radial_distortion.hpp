#pragma once

namespace octurn {

/// Brown's radial distortion of a lens, on normalised coordinates: a point at radius r from the
/// principal point appears at r (1 + k1 r^2 + k2 r^4).
struct RadialDistortion {
  double k1 = 0;
  double k2 = 0;

  /// The factor from undistorted coordinates at `radius` to distorted ones.
  double distorting_factor(double radius) const { return 1 + shift(radius * radius); }

  /// The same less one. @param square  of the radius
  double shift(double square) const { return square * (k1 + square * k2); }

  /// The factor from distorted coordinates at `distorted_radius` to undistorted ones, by Newton's
  /// method.
  /// @param distorted_radius  at most one that passed `is_invertible_to`
  double undistorting_factor(double distorted_radius) const;

  /// Whether the distortion is one-to-one up to `distorted_radius`: beyond a maximum it folds the
  /// picture over.
  bool is_invertible_to(double distorted_radius) const;

 private:
  double distorted(double r) const { return r * distorting_factor(r); }
  double slope(double r) const { return 1 + r * r * (3 * k1 + r * r * 5 * k2); }
};

}  // namespace octurn
