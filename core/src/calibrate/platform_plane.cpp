#include "calibrate/platform_plane.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/units.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// The configured surface may be wrong by 30 mm and 5 degrees, which is 15 mm at the largest radius.
constexpr double max_surface_height = 0.06;  // metres from the configured surface
constexpr double max_surface_radius = 0.17;  // metres from the axis
constexpr double max_slope_deg = 6;          // of a plane, against the configured surface
constexpr double inlier_height = 0.003;
constexpr double object_height = 0.006;  // above the plane: more than the platform's noise
constexpr int candidates = 400;
constexpr std::size_t scored_points = 4000;  // that score a candidate
constexpr std::size_t fitted_points = 60000;
constexpr double good_support = 0.6;  // of the best candidate's
constexpr int refinements = 8;
constexpr double cauchy_scale = 0.001;  // metres
constexpr double refined_height = 0.01;

/// Random numbers, the same on every machine (PCG XSH RR 64/32, O'Neill 2014).
class Random {
 public:
  std::size_t below(std::size_t end) {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
    const auto mixed = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto turn = static_cast<std::uint32_t>(old >> 59U);
    const std::uint32_t bits = (mixed >> turn) | (mixed << (-turn & 31U));
    return static_cast<std::size_t>((std::uint64_t{bits} * end) >> 32U);
  }

 private:
  std::uint64_t state_ = 0x853c49e6748fea9bULL;
};

struct Candidate {
  Vector3d normal = Vector3d::UnitZ();
  double offset = 0;
  std::size_t support = 0;
};

/// The plane through three points, upward; nothing if it is too steep against `up`.
std::optional<Candidate> plane_through(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                                       const Vector3d& up) {
  Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 1e-6)) {
    return std::nullopt;
  }
  normal /= normal.dot(up) < 0 ? -length : length;
  if (normal.dot(up) < std::cos(radians_from_degrees(max_slope_deg))) {
    return std::nullopt;
  }
  return Candidate{.normal = normal, .offset = normal.dot(a)};
}

/// Whether a reading may be the platform's: near the surface as configured, and near its axis.
/// @param point  metres, in the platform's frame as configured
bool may_be_platform(const Vector3d& point) {
  return std::abs(point.z()) < max_surface_height &&
         point.head<2>().squaredNorm() < max_surface_radius * max_surface_radius;
}

/// Readings that `accept(pixel, point)` takes, spread over all stops.
template <typename Accept>
std::vector<Vector3d> spread(const PlatformSamples& samples, std::size_t count, Accept accept) {
  std::vector<Vector3d> points;
  for (const std::vector<float>& depths : samples.depths) {
    for (std::size_t pixel = 0; pixel < depths.size(); ++pixel) {
      const Vector3d point = samples.rays[pixel] * static_cast<double>(depths[pixel]);
      if (depths[pixel] > 0 && accept(pixel, point)) {
        points.push_back(point);
      }
    }
  }
  const std::size_t step = std::max<std::size_t>(points.size() / count, 1);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += step) {
    points[kept++] = points[i];
  }
  points.resize(kept);
  return points;
}

/// Whether most stops read the plane at a pixel, and none anything above it.
bool is_plane_at(const PlatformSamples& samples, const PlatformPlane& plane, std::size_t pixel) {
  double heights = 0;
  std::size_t count = 0;
  for (const std::vector<float>& depths : samples.depths) {
    if (depths[pixel] > 0) {
      const double height = plane.height(samples.rays[pixel] * static_cast<double>(depths[pixel]));
      if (height > object_height) {
        return false;
      }
      heights += height;
      ++count;
    }
  }
  return 2 * count > samples.depths.size() &&
         std::abs(heights / static_cast<double>(count)) < inlier_height;
}

/// The lowest of the candidates with much support.
std::optional<Candidate> find_plane(const std::vector<Vector3d>& points,
                                    const Eigen::Isometry3d& platform_from_sensor) {
  const Eigen::Isometry3d sensor_from_platform = platform_from_sensor.inverse();
  const Vector3d up = sensor_from_platform.linear() * Vector3d::UnitZ();
  const Vector3d origin = sensor_from_platform.translation();
  std::vector<Candidate> found;
  Random random;
  for (int i = 0; i < candidates; ++i) {
    const Vector3d& a = points[random.below(points.size())];
    const Vector3d& b = points[random.below(points.size())];
    const Vector3d& c = points[random.below(points.size())];
    if (auto candidate = plane_through(a, b, c, up)) {
      candidate->support =
          static_cast<std::size_t>(std::ranges::count_if(points, [&](const Vector3d& point) {
            return std::abs(candidate->normal.dot(point) - candidate->offset) < inlier_height;
          }));
      found.push_back(*candidate);
    }
  }
  const auto best = std::ranges::max_element(found, {}, &Candidate::support);
  if (best == found.end()) {
    return std::nullopt;
  }
  const double enough = good_support * static_cast<double>(best->support);
  // Along the configured axis: the offset of a plane is no height where its normal differs.
  const auto height = [&](const Candidate& plane) {
    return (plane.offset - plane.normal.dot(origin)) / plane.normal.dot(up);
  };
  const Candidate* lowest = &*best;
  for (const Candidate& plane : found) {
    if (static_cast<double>(plane.support) >= enough &&
        height(plane) < height(*lowest) - 2 * inlier_height) {
      lowest = &plane;
    }
  }
  return *lowest;
}

}  // namespace

Eigen::Quaterniond rotation_to_z(const Vector3d& vector) {
  const Vector3d from = vector.normalized();
  const double cosine = from.z();
  if (cosine < -1 + 1e-12) {
    return {0, 1, 0, 0};  // half a turn about x, as any axis would do
  }
  const double norm = std::sqrt((1 + cosine) * 2);  // of (1 + cosine, from x z)
  Eigen::Quaterniond rotation;
  rotation.vec() = from.cross(Vector3d::UnitZ()) * (1 / norm);
  rotation.w() = norm * 0.5;
  return rotation;
}

namespace {

/// One weighted least-squares fit of z = a x + b y + c in a frame in which the plane is level.
void refine(PlatformPlane& plane, const std::vector<Vector3d>& points) {
  const Eigen::Quaterniond level = rotation_to_z(plane.normal);
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Vector3d& point : points) {
    const double distance = plane.height(point);
    if (std::abs(distance) > refined_height) {
      continue;
    }
    const double weight = cauchy_weight(distance, cauchy_scale);
    const Vector3d levelled = level * point;
    const Vector3d row(levelled.x(), levelled.y(), 1);
    normal_matrix += weight * row * row.transpose();
    right += weight * distance * row;
  }
  const Vector3d fit = normal_matrix.ldlt().solve(right);
  if (!fit.allFinite()) {
    return;  // all points on a line: the plane stays
  }
  const Vector3d tilted = Vector3d(-fit.x(), -fit.y(), 1);
  const double length = tilted.norm();
  plane.normal = level.inverse() * (tilted / length);
  plane.offset = (plane.offset + fit.z()) / length;
}

// A platform of 28 cm, 0.7 m away, has a thousand samples; a large object leaves a few hundred.
constexpr std::size_t min_inliers = 200;
constexpr double min_share = 0.3;

}  // namespace

std::vector<bool> find_plane_pixels(const PlatformSamples& samples, const PlatformPlane& plane) {
  const std::size_t columns = samples.columns;
  std::vector<bool> seen(samples.rays.size());
  for (std::size_t pixel = 0; pixel < seen.size(); ++pixel) {
    seen[pixel] = is_plane_at(samples, plane, pixel);
  }
  std::vector<bool> inner(seen.size(), false);
  for (std::size_t pixel = columns + 1; pixel + columns + 1 < seen.size(); ++pixel) {
    const auto row = [&](std::size_t middle) {
      return seen[middle - 1] && seen[middle] && seen[middle + 1];
    };
    inner[pixel] = row(pixel - columns) && row(pixel) && row(pixel + columns);
  }
  return inner;
}

std::optional<PlatformPlane> fit_platform_plane(const PlatformSamples& samples,
                                                const Eigen::Isometry3d& platform_from_sensor) {
  const auto near = [&](std::size_t, const Vector3d& point) {
    return may_be_platform(platform_from_sensor * point);
  };
  const std::vector<Vector3d> scored = spread(samples, scored_points, near);
  if (scored.size() < 3) {
    return std::nullopt;
  }
  const auto found = find_plane(scored, platform_from_sensor);
  if (!found) {
    return std::nullopt;
  }
  return refine_platform_plane(samples, platform_from_sensor,
                               {.normal = found->normal, .offset = found->offset});
}

PlatformPlane refine_platform_plane(const PlatformSamples& samples,
                                    const Eigen::Isometry3d& platform_from_sensor,
                                    const PlatformPlane& nearly) {
  const auto near = [&](std::size_t, const Vector3d& point) {
    return may_be_platform(platform_from_sensor * point);
  };
  PlatformPlane plane{.normal = nearly.normal, .offset = nearly.offset};
  const std::vector<bool> is_plane = find_plane_pixels(samples, plane);
  const std::vector<Vector3d> fitted =
      spread(samples, fitted_points, [&](std::size_t pixel, const Vector3d& point) {
        return is_plane[pixel] && near(pixel, point);
      });
  for (int i = 0; i < refinements; ++i) {
    refine(plane, fitted);
  }
  double squares = 0;
  for (const Vector3d& point : fitted) {
    const double distance = plane.height(point);
    if (std::abs(distance) < inlier_height) {
      ++plane.inliers;
      squares += distance * distance;
    }
  }
  plane.inlier_share = static_cast<double>(plane.inliers) /
                       static_cast<double>(std::max<std::size_t>(fitted.size(), 1));
  plane.rms = plane.inliers > 0 ? std::sqrt(squares / static_cast<double>(plane.inliers)) : 0;
  return plane;
}

Eigen::Isometry3d level(const Eigen::Isometry3d& platform_from_sensor, const PlatformPlane& plane) {
  const Vector3d normal = platform_from_sensor.linear() * plane.normal;
  Eigen::Isometry3d levelled = rotation_to_z(normal) * platform_from_sensor;
  // The plane's height in the levelled frame, at any of its points.
  levelled.translation().z() -= (levelled * (plane.normal * plane.offset)).z();
  return levelled;
}

PlatformSamples make_platform_samples(const Intrinsics& lens, std::size_t stops) {
  PlatformSamples samples{
      .columns = static_cast<std::size_t>((lens.width + platform_step - 1) / platform_step),
      .rays = {},
      .depths = std::vector<std::vector<float>>(stops)};
  for (int v = 0; v < lens.height; v += platform_step) {
    for (int u = 0; u < lens.width; u += platform_step) {
      samples.rays.push_back(to_ray(lens, u, v));
    }
  }
  return samples;
}

std::vector<float> sample_depths(const DepthFrame& frame, const Intrinsics& lens) {
  check_size(frame, lens, "calibrate");
  std::vector<float> depths;
  for (int v = 0; v < frame.height; v += platform_step) {
    for (int u = 0; u < frame.width; u += platform_step) {
      const auto z = static_cast<float>(
          frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                      static_cast<std::size_t>(u)] *
          lens.depth_unit);
      depths.push_back(static_cast<double>(z) > nearest_z ? z : 0.0F);
    }
  }
  return depths;
}

std::optional<PlatformSurface> measure_platform_surface(
    const DepthFrame& frame, const Intrinsics& intrinsics,
    const Eigen::Isometry3d& platform_from_sensor) {
  PlatformSamples samples = make_platform_samples(intrinsics, 1);
  samples.depths.front() = sample_depths(frame, intrinsics);
  const auto plane = fit_platform_plane(samples, platform_from_sensor);
  if (!plane || plane->inliers < min_inliers || plane->inlier_share < min_share) {
    return std::nullopt;
  }
  // On the plane normal . p = offset; with p = (0, 0, height) of the configured frame on the
  // configured axis.
  const Eigen::Vector3d normal = platform_from_sensor.linear() * plane->normal;
  const double offset = plane->offset + normal.dot(platform_from_sensor.translation());
  return PlatformSurface{.height = offset / normal.z(),
                         .slope = -normal.head<2>() / normal.z(),
                         .tilt = std::atan2(normal.head<2>().norm(), normal.z())};
}

}  // namespace octurn
