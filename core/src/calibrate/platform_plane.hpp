#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// The platform's surface in the sensor's optical frame.
struct PlatformPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< upward, of length one
  double offset = 0;                                  ///< metres: normal . point = offset on it
  std::size_t inliers = 0;                            ///< readings that support it
  double inlier_share = 0;  ///< of the readings near the configured surface
  double rms = 0;           ///< metres, of their distances

  double height(const Eigen::Vector3d& point) const { return normal.dot(point) - offset; }
};

/// A coarse grid of pixels of the depth images of all stops, row by row.
struct PlatformSamples {
  std::size_t columns = 0;
  std::vector<Eigen::Vector3d> rays = {};       ///< of the pixels, optical frame, z = 1
  std::vector<std::vector<float>> depths = {};  ///< of each stop, metres along z; 0: no reading
};

/// Fits the platform's plane: RANSAC among planes that are nearly level in the configured pose,
/// then least squares with Cauchy weights. If several planes have much support, the lowest is the
/// platform: the lid of a flat box may be larger. Least squares use only the pixels of
/// `find_plane_pixels`: the object's foot and the rim would tilt the plane.
///
/// @param platform_from_sensor as configured
/// @return nothing if no nearly level plane has any support
std::optional<PlatformPlane> fit_platform_plane(const PlatformSamples& samples,
                                                const Eigen::Isometry3d& platform_from_sensor);

/// For each pixel of the grid, whether it and its eight neighbours see the plane: at more than half
/// of the stops, on average at its height, and at no stop anything above it.
std::vector<bool> find_plane_pixels(const PlatformSamples& samples, const PlatformPlane& plane);

/// Only the least squares of `fit_platform_plane`, from a plane that is nearly right.
PlatformPlane refine_platform_plane(const PlatformSamples& samples,
                                    const Eigen::Isometry3d& platform_from_sensor,
                                    const PlatformPlane& nearly);

/// The smallest rotation that takes a vector to the z axis; half a turn about x if it is opposite.
/// Eigen's FromTwoVectors is the same, but takes ten seconds to compile.
Eigen::Quaterniond rotation_to_z(const Eigen::Vector3d& vector);

/// The pose of least rotation from the configured one in which the plane is z = 0.
Eigen::Isometry3d level(const Eigen::Isometry3d& platform_from_sensor, const PlatformPlane& plane);

/// Pixels between readings that the plane is fitted to.
inline constexpr int platform_step = 4;

/// A grid of every fourth pixel in both directions, with its rays and room for the depths of stops.
PlatformSamples make_platform_samples(const Intrinsics& lens, std::size_t stops);

/// The depths of a frame at that grid's pixels, metres along z; 0 is no reading.
/// @throws std::invalid_argument  if the frame has another size than the intrinsics say
std::vector<float> sample_depths(const DepthFrame& frame, const Intrinsics& lens);

}  // namespace octurn
