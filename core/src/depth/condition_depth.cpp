#include "depth/condition_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

constexpr int border = fit_window_side / 2;  // pixels at the image's edges that observe nothing
constexpr float min_cosine = 0.15F;          // of incidence: 81 degrees
constexpr double object_share = 0.9;         // of the depth of the platform's middle
constexpr double platform_slack = 0.0015;    // metres above the platform that may be the platform

// Slack for one of several poses, which need not see the foot, as another pose does. Readings up to
// `foot_height` may mix object and platform, and get less weight.
constexpr double foot_slack = 0.0025;  // metres
constexpr float foot_height = 0.007F;  // metres

// A ray that ends on its pose's platform is free this much further than other rays without a
// surface, as the platform's height is known. With the usual margin (`free_margin`) the lowest 3 mm
// beside the foot would stay unknown, and another pose would take them for the object.
constexpr float platform_reach = 0.0045F;  // metres, along the optical axis

DepthImage to_metres(const Snapshot& snapshot) {
  const DepthFrame& frame = snapshot.frame;
  const auto unit = static_cast<float>(snapshot.intrinsics.depth_unit);
  DepthImage image{.width = frame.width, .height = frame.height, .z = {}};
  image.z.resize(frame.depth.size());
  std::ranges::transform(frame.depth, image.z.begin(),
                         [&](std::uint16_t depth) { return static_cast<float>(depth) * unit; });
  return image;
}

/// The smallest reading in the 3 x 3 window of each pixel of a row: a ray beside an edge is free no
/// further than the edge.
/// @param column_min  buffer for a row
void find_min_around(const DepthImage& image, int v, std::vector<float>& column_min,
                     std::vector<float>& min) {
  constexpr float none = std::numeric_limits<float>::max();
  const float* const row = image.row(v);
  for (int u = 0; u < image.width; ++u) {
    float z = none;
    for (int dv = -1; dv <= 1; ++dv) {
      const float other = row[dv * image.width + u];
      z = std::min(z, other > 0 ? other : none);
    }
    column_min[static_cast<std::size_t>(u)] = z;
  }
  for (std::size_t u = 1; u + 1 < column_min.size(); ++u) {
    const float left = column_min[u - 1];
    const float right = column_min[u + 1];
    const float here = column_min[u];
    min[u] = std::min(here, std::min(left, right));
  }
}

using Ray = std::array<float, 3>;  // from the sensor, of depth 1

/// The clip box above the platform's noise, and the pose that takes readings into its frame.
struct ClipVolume {
  Eigen::Vector3f min;
  Eigen::Vector3f max;
  Eigen::Matrix3f rotation;
  Eigen::Vector3f centre;

  ClipVolume(const Box& clip, const Eigen::Isometry3d& object_from_sensor, double lowest)
      : min(clip.min.cast<float>()),
        max(clip.max.cast<float>()),
        rotation(object_from_sensor.linear().cast<float>()),
        centre(object_from_sensor.translation().cast<float>()) {
    min.z() = std::max(min.z(), static_cast<float>(lowest));
  }

  /// Clears the flags (1 or 0) of the pixels of a row whose readings lie outside.
  void mask(const DepthImage& image, int v, const std::vector<float>& ray_x, float ray_y,
            std::vector<int>& inside) const {
    const float* const row = image.row(v);
    for (int axis = 0; axis < 3; ++axis) {
      const float along_x = rotation(axis, 0);
      const float along_y = rotation(axis, 1) * ray_y;
      const float along_z = rotation(axis, 2);
      const float from = centre[axis];
      const float low = min[axis];
      const float high = max[axis];
      for (std::size_t u = 0; u < inside.size(); ++u) {  // without branches, to be vectorised
        const float at = row[u] * (along_x * ray_x[u] + along_y + along_z) + from;
        inside[u] &= (at >= low ? 1 : 0) & (at <= high ? 1 : 0);
      }
    }
  }
};

/// The volume whose readings are the object's: inside the clip box and, of one of several poses,
/// inside that pose's own box.
class ObjectVolume {
 public:
  /// Of an object on the platform.
  ObjectVolume(const Snapshot& snapshot, const Box& clip)
      : clip_(clip, snapshot.object_from_sensor, platform_slack) {}

  ObjectVolume(const Snapshot& snapshot, const Box& clip, const Placement& placement)
      : ObjectVolume(without_platform(snapshot, clip)) {
    own_.emplace(placement.clip,
                 placement.object_from_platform.inverse() * snapshot.object_from_sensor,
                 foot_slack);
  }

  static ObjectVolume without_platform(const Snapshot& snapshot, const Box& clip) {
    return ObjectVolume(
        ClipVolume(clip, snapshot.object_from_sensor, std::numeric_limits<double>::lowest()));
  }

  /// Sets the flags of a row's pixels: 1 where the reading lies inside, else 0.
  void mask(const DepthImage& image, int v, const std::vector<float>& ray_x, float ray_y,
            std::vector<int>& inside) const {
    std::ranges::fill(inside, 1);
    clip_.mask(image, v, ray_x, ray_y, inside);
    if (own_) {
      own_->mask(image, v, ray_x, ray_y, inside);
    }
  }

  /// Factor of a reading's weight: below 1 near the platform of one of several poses.
  float share(const Ray& ray, float z) const {
    if (!own_) {
      return 1;
    }
    return std::clamp((height(ray, z) - lowest) / (foot_height - lowest), 0.0F, 1.0F);
  }

  /// Added to the free-space depth of a reading that makes no surface.
  float reach(const Ray& ray, float z) const {
    return own_ && std::abs(height(ray, z)) < lowest ? platform_reach : 0.0F;
  }

 private:
  static constexpr auto lowest = static_cast<float>(foot_slack);

  explicit ObjectVolume(const ClipVolume& clip) : clip_(clip) {}

  /// Height of a reading above its pose's platform, metres.
  float height(const Ray& ray, float z) const {
    const Eigen::Matrix3f& r = own_->rotation;
    return z * (r(2, 0) * ray[0] + r(2, 1) * ray[1] + r(2, 2) * ray[2]) + own_->centre.z();
  }

  ClipVolume clip_;
  std::optional<ClipVolume> own_ = {};
};

/// Stores the surface that was fitted at a ray, unless it is seen at grazing incidence.
///
/// The weight follows the inverse variance of the distance to the plane: depth noise grows with z^2
/// (Khoshelham and Elberink 2012), and falls with the number of averaged readings.
void set_surface(DepthObservation& observation, const PlaneFit& fit, const Intrinsics& intrinsics,
                 const Ray& ray, float reference_depth, float z) {
  if (fit.inverse_depth <= 0) {
    return;
  }
  const float a = fit.slope_u * static_cast<float>(intrinsics.fx);
  const float b = fit.slope_v * static_cast<float>(intrinsics.fy);
  const float c = fit.inverse_depth - a * ray[0] - b * ray[1];
  const float norm = std::sqrt(a * a + b * b + c * c);
  const float length = std::sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1);
  const float cosine = fit.inverse_depth / (norm * length);
  if (cosine < min_cosine) {
    return;
  }
  constexpr auto window_samples = static_cast<float>(fit_window_side * fit_window_side);
  const float close = reference_depth / z;
  const float share = static_cast<float>(fit.samples) / window_samples;
  observation.normal = {-a / norm, -b / norm, -c / norm};
  observation.offset = 1 / norm;
  observation.weight = close * close * close * close * share * share / cosine;
}

/// The depth at which a whole window has weight 1, metres. It is proportional to the depth of the
/// platform's middle, which is the same at all stops of a turn, so that weights do not depend on
/// the sensor's distance.
/// @param middle  of the platform, metres, object's frame
double find_reference_depth(const Snapshot& snapshot, const Eigen::Vector3d& middle) {
  const double z = (snapshot.object_from_sensor.inverse() * middle).z();
  return object_share * std::max(z, nearest_z);
}

std::vector<DepthObservation> condition_depth(const Snapshot& snapshot, const ObjectVolume& volume,
                                              double reference_depth) {
  const Intrinsics& intrinsics = snapshot.intrinsics;
  check_size(snapshot.frame, intrinsics, "ConditionedDepth");
  const DepthImage image = remove_speckle(to_metres(snapshot));
  const std::vector<float> inverse_depth = to_inverse_depth(image);
  const auto reference = static_cast<float>(reference_depth);

  const auto width = static_cast<std::size_t>(intrinsics.width);
  std::vector<float> ray_x(width);
  for (std::size_t u = 0; u < width; ++u) {
    ray_x[u] = static_cast<float>((static_cast<double>(u) - intrinsics.cx) / intrinsics.fx);
  }
  std::vector<float> column_min(width);
  std::vector<float> min_around(width);
  std::vector<int> inside(width);
  std::vector<DepthObservation> observations(snapshot.frame.depth.size());
  for (int v = border; v + border < intrinsics.height; ++v) {
    const auto ray_y = static_cast<float>((v - intrinsics.cy) / intrinsics.fy);
    find_min_around(image, v, column_min, min_around);
    volume.mask(image, v, ray_x, ray_y, inside);
    for (int u = border; u + border < intrinsics.width; ++u) {
      const float z = image.at(u, v);
      if (z == 0) {
        continue;
      }
      const auto column = static_cast<std::size_t>(u);
      DepthObservation& observation = observations[static_cast<std::size_t>(v) * width + column];
      observation.free_space_depth = min_around[column];
      const Ray ray{ray_x[column], ray_y, 1.0F};
      if (inside[column] == 0) {
        observation.free_space_depth += volume.reach(ray, z);
        continue;
      }
      if (const auto fit = fit_plane(image, inverse_depth, u, v)) {
        set_surface(observation, *fit, intrinsics, ray, reference, z);
        observation.weight *= volume.share(ray, z);
      }
    }
  }
  return observations;
}

constexpr int min_support = 5;  // of the nine readings in a window

}  // namespace

ConditionedDepth::ConditionedDepth(const Snapshot& snapshot,
                                   std::vector<DepthObservation> observations)
    : intrinsics_(snapshot.intrinsics),
      sensor_from_object_(snapshot.object_from_sensor.inverse()),
      observations_(std::move(observations)),
      pyramid_(observations_, intrinsics_.width, intrinsics_.height) {}

ConditionedDepth::ConditionedDepth(const Snapshot& snapshot, const Box& clip)
    : ConditionedDepth(snapshot,
                       condition_depth(snapshot, ObjectVolume(snapshot, clip),
                                       find_reference_depth(snapshot, Eigen::Vector3d::Zero()))) {}

ConditionedDepth::ConditionedDepth(const Snapshot& snapshot, const Box& clip,
                                   const Placement& placement)
    : ConditionedDepth(
          snapshot, condition_depth(snapshot, ObjectVolume(snapshot, clip, placement),
                                    find_reference_depth(
                                        snapshot, placement.object_from_platform.translation()))) {}

ConditionedDepth::ConditionedDepth(const Snapshot& snapshot, const Box& clip,
                                   double reference_depth)
    : ConditionedDepth(snapshot,
                       condition_depth(snapshot, ObjectVolume::without_platform(snapshot, clip),
                                       reference_depth)) {}

ConditionedDepth::ConditionedDepth(const Intrinsics& intrinsics,
                                   const Eigen::Isometry3d& sensor_from_object,
                                   std::vector<DepthObservation> observations)
    : intrinsics_(intrinsics),
      sensor_from_object_(sensor_from_object),
      observations_(std::move(observations)),
      pyramid_(observations_, intrinsics_.width, intrinsics_.height) {}

namespace {

constexpr int min_samples = 9;

// Separable weights along u and v. Integration averages snapshots, so that a wider window loses
// more by rounding off edges than it gains: with 0.75 and 0.35 beside the middle 36 snapshots lose
// 0.03 mm of accuracy.
constexpr std::array<float, fit_window_side> window{0.05F, 0.35F, 1.0F, 0.35F, 0.05F};

constexpr float min_determinant = 0.05F;  // of the covariance of u and v, pixels^4: 0 on a line

/// Weighted moments of samples (u, v, q), from which a plane q(u, v) is solved.
struct WeightedPlane {
  float w = 0;
  float u = 0;
  float v = 0;
  float q = 0;
  float uu = 0;
  float uv = 0;
  float vv = 0;
  float uq = 0;
  float vq = 0;

  void add(float weight, float at_u, float at_v, float value) {
    w += weight;
    u += weight * at_u;
    v += weight * at_v;
    q += weight * value;
    uu += weight * at_u * at_u;
    uv += weight * at_u * at_v;
    vv += weight * at_v * at_v;
    uq += weight * at_u * value;
    vq += weight * at_v * value;
  }

  /// The normal equations of the centred samples, by Cramer's rule.
  /// @param offset  inverse depth to which the values are relative, 1/m
  std::optional<PlaneFit> solve(float offset, int samples) const {
    const float mean_u = u / w;
    const float mean_v = v / w;
    const float mean_q = q / w;
    const float cov_uu = uu / w - mean_u * mean_u;
    const float cov_uv = uv / w - mean_u * mean_v;
    const float cov_vv = vv / w - mean_v * mean_v;
    const float cov_uq = uq / w - mean_u * mean_q;
    const float cov_vq = vq / w - mean_v * mean_q;
    const float determinant = cov_uu * cov_vv - cov_uv * cov_uv;
    if (determinant < min_determinant) {
      return std::nullopt;
    }
    const float slope_u = (cov_uq * cov_vv - cov_vq * cov_uv) / determinant;
    const float slope_v = (cov_vq * cov_uu - cov_uq * cov_uv) / determinant;
    return PlaneFit{.inverse_depth = offset + mean_q - slope_u * mean_u - slope_v * mean_v,
                    .slope_u = slope_u,
                    .slope_v = slope_v,
                    .samples = samples};
  }
};

}  // namespace

std::vector<float> to_inverse_depth(const DepthImage& image) {
  std::vector<float> inverse_depth(image.z.size());
  for (std::size_t i = 0; i < inverse_depth.size(); ++i) {
    inverse_depth[i] = image.z[i] > 0 ? 1.0F / image.z[i] : 0.0F;
  }
  return inverse_depth;
}

std::optional<PlaneFit> fit_plane(const DepthImage& image, const std::vector<float>& inverse_depth,
                                  int u, int v) {
  const float z = image.at(u, v);
  // Values are relative to the middle's, so that sums of floats keep their precision.
  const float offset = inverse_depth[static_cast<std::size_t>(v * image.width + u)];
  WeightedPlane plane;
  int samples = 0;
  for (int dv = -border; dv <= border; ++dv) {
    for (int du = -border; du <= border; ++du) {
      if (std::abs(image.at(u + du, v + dv) - z) > depth_step_limit) {
        continue;
      }
      ++samples;
      plane.add(window[static_cast<std::size_t>(du + border)] *
                    window[static_cast<std::size_t>(dv + border)],
                static_cast<float>(du), static_cast<float>(dv),
                inverse_depth[static_cast<std::size_t>((v + dv) * image.width + u + du)] - offset);
    }
  }
  return samples < min_samples ? std::nullopt : plane.solve(offset, samples);
}

DepthImage remove_speckle(const DepthImage& image) {
  DepthImage kept{.width = image.width, .height = image.height, .z = {}};
  kept.z.resize(image.z.size());
  for (int v = 1; v + 1 < image.height; ++v) {
    const float* const row = image.row(v);
    float* const kept_row = kept.row(v);
    for (int u = 1; u + 1 < image.width; ++u) {  // without branches, so that it is vectorised
      const float z = row[u];
      int support = 0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          support += std::abs(row[dv * image.width + u + du] - z) <= depth_step_limit ? 1 : 0;
        }
      }
      kept_row[u] = support >= min_support ? z : 0.0F;
    }
  }
  return kept;
}

}  // namespace octurn
