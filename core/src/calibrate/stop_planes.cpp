#include "calibrate/stop_planes.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr std::size_t min_stops = 6;
constexpr std::size_t min_pixels = 500;

/// The pixels that see the platform at every stop. All stops use the same pixels, so that a pixel's
/// fixed error is the same at each.
std::vector<std::size_t> always_seen(const PlatformSamples& samples,
                                     const std::vector<bool>& is_plane) {
  std::vector<std::size_t> pixels;
  for (std::size_t pixel = 0; pixel < samples.rays.size(); ++pixel) {
    bool is_seen = is_plane[pixel];
    for (const std::vector<float>& depths : samples.depths) {
      is_seen = is_seen && depths[pixel] > 0;
    }
    if (is_seen) {
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

double inverse(float depth) { return 1 / static_cast<double>(depth); }

/// The mean over all stops of each pixel's inverse depth, 1/m.
std::vector<double> mean_inverse_depths(const PlatformSamples& samples,
                                        const std::vector<std::size_t>& pixels) {
  std::vector<double> means;
  means.reserve(pixels.size());
  for (const std::size_t pixel : pixels) {
    double sum = 0;
    for (const std::vector<float>& depths : samples.depths) {
      sum += inverse(depths[pixel]);
    }
    means.push_back(sum / static_cast<double>(samples.depths.size()));
  }
  return means;
}

}  // namespace

std::vector<StopPlane> measure_stop_planes(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane,
                                           const Eigen::Isometry3d& levelled) {
  const std::vector<std::size_t> pixels = always_seen(samples, is_plane);
  if (samples.depths.size() < min_stops || pixels.size() < min_pixels) {
    return {};
  }
  const std::vector<double> means = mean_inverse_depths(samples, pixels);
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const std::size_t pixel : pixels) {
    square += samples.rays[pixel] * samples.rays[pixel].transpose();
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(square);

  const Vector3d middle = levelled.inverse().translation();
  std::vector<StopPlane> planes;
  planes.reserve(samples.depths.size());
  for (const std::vector<float>& depths : samples.depths) {
    Vector3d right = Vector3d::Zero();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      right += samples.rays[pixels[i]] * (inverse(depths[pixels[i]]) - means[i]);
    }
    // A plane is 1/z = (normal / offset) . ray.
    const Vector3d seen = plane.normal / plane.offset + solver.solve(right);
    const Vector3d normal = std::copysign(1.0, plane.offset) * seen.normalized();
    planes.push_back({.tilt = (levelled.linear() * normal).head<2>(),
                      .height = std::copysign(1 / seen.norm(), plane.offset) - normal.dot(middle)});
  }
  return planes;
}

}  // namespace octurn
