#include "capture/seen_rotation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"

namespace octurn {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int smooth_radius = 4;            // pixels
constexpr double max_surface_step = 0.008;  // metres
constexpr int point_step = 2;               // in both directions: thousands of points are enough
constexpr std::size_t min_points = 150;     // those of an object of 2 cm at 0.7 m
constexpr double half_fit = 0.005;          // metres: three depth steps of a Kinect at 0.7 m
// Excludes the platform, which looks the same at every angle, with its noise and a pose that is
// some degrees off.
constexpr double min_height = 0.02;  // metres
constexpr double coarse_step_deg = 1;
constexpr double min_step_deg = 0.02;
constexpr double beside_deg = 4;

/// The mean of the readings around a pixel that are on the same surface as its own.
/// @param same_surface  maximum difference on one surface, in the frame's units
/// @return 0 if the pixel has no reading
int mean_around(const DepthFrame& frame, int u, int v, int same_surface) {
  const auto at = [&](int column, int row) {
    return static_cast<int>(
        frame.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.width) +
                    static_cast<std::size_t>(column)]);
  };
  const int centre = at(u, v);
  if (centre == 0) {
    return 0;
  }
  const int right = std::min(u + smooth_radius, frame.width - 1);
  const int bottom = std::min(v + smooth_radius, frame.height - 1);
  int sum = 0;
  int count = 0;  // the pixel's own reading is among them
  for (int row = std::max(v - smooth_radius, 0); row <= bottom; ++row) {
    for (int column = std::max(u - smooth_radius, 0); column <= right; ++column) {
      const int other = at(column, row);
      const bool is_near = other > 0 && std::abs(other - centre) <= same_surface;
      sum += is_near ? other - centre : 0;
      count += is_near ? 1 : 0;
    }
  }
  return centre + sum / count;
}

/// A pixel's reading as a point in the platform frame, metres; NaN if there is no reading.
Eigen::Vector3d point_at(const PlatformLook& view, const DepthFrame& frame, int u, int v) {
  const Intrinsics& lens = view.intrinsics;
  const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                            static_cast<std::size_t>(u);
  const double reading = frame.depth[pixel] * lens.depth_unit;
  const double z = reading > 0 ? reading : std::numeric_limits<double>::quiet_NaN();
  return view.platform_from_sensor * (z * pixel_ray(lens, u, v));
}

/// Smooths the sensor's depth quantisation: its steps stay in place while the object turns, and
/// would bias the rotation towards 0. Each reading inside the clip box becomes the mean of those
/// around it on the same surface.
DepthFrame smoothed(const PlatformLook& view, const DepthFrame& frame) {
  const auto same_surface = static_cast<int>(max_surface_step / view.intrinsics.depth_unit);
  DepthFrame smooth = frame;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      if (contains(view.clip, point_at(view, frame, u, v))) {
        smooth.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                     static_cast<std::size_t>(u)] =
            static_cast<std::uint16_t>(mean_around(frame, u, v, same_surface));
      }
    }
  }
  return smooth;
}

/// Points inside the clip box and above the platform, in the platform frame.
Points points_in(const PlatformLook& view, const DepthFrame& frame) {
  Points points;
  for (int v = 0; v < frame.height; v += point_step) {
    for (int u = 0; u < frame.width; u += point_step) {
      const Eigen::Vector3d point = point_at(view, frame, u, v);
      if (point.z() >= min_height && contains(view.clip, point)) {
        points.push_back(point);
      }
    }
  }
  return points;
}

/// Robust misfit of a point in the sensor's frame to a depth frame, from 0 to 1 (Geman and McClure
/// 1985). It is quadratic near 0, so that the sensor's depth steps, which do not move, do not bias
/// the rotation towards 0.
double misfit(const Intrinsics& lens, const DepthFrame& frame, const Eigen::Vector3d& point) {
  const double u = std::round(lens.cx + lens.fx * point.x() / point.z());
  const double v = std::round(lens.cy + lens.fy * point.y() / point.z());
  if (!(point.z() > 0 && u >= 0 && v >= 0 && u < frame.width && v < frame.height)) {
    return 1;
  }
  const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                            static_cast<std::size_t>(u);
  const double seen = frame.depth[pixel] * lens.depth_unit;
  const double square = (point.z() - seen) * (point.z() - seen);
  return seen > 0 ? square / (square + half_fit * half_fit) : 1;
}

/// A motion of the platform: a rotation about the z axis of the platform frame of `PlatformLook`,
/// and a translation that makes it a rotation about the true axis.
struct PlanarMotion {
  double deg = 0;
  double x = 0;  ///< metres
  double y = 0;
};

Eigen::Isometry3d to_isometry(const PlanarMotion& motion) {
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  moved.linear() =
      Eigen::AngleAxisd(radians_from_degrees(motion.deg), Eigen::Vector3d::UnitZ()).matrix();
  moved.translation() << motion.x, motion.y, 0;
  return moved;
}

/// Mean misfit of moved points to a depth frame.
double mean_misfit(const PlatformLook& view, const Points& points, const DepthFrame& frame,
                   const Eigen::Isometry3d& motion) {
  const Eigen::Isometry3d moved = view.platform_from_sensor.inverse() * motion;
  double sum = 0;
  for (const Eigen::Vector3d& point : points) {
    sum += misfit(view.intrinsics, frame, moved * point);
  }
  return sum / static_cast<double>(points.size());
}

/// Two depth frames, and their mutual misfit for a motion from the first to the second.
class FramePair {
 public:
  FramePair(const PlatformLook& view, const DepthFrame& from, const DepthFrame& to)
      : view_(view),
        from_(smoothed(view, from)),
        to_(smoothed(view, to)),
        points_from_(points_in(view, from_)),
        points_to_(points_in(view, to_)) {}

  bool see_an_object() const {
    return std::min(points_from_.size(), points_to_.size()) >= min_points;
  }

  double disagreement(const PlanarMotion& motion) const {
    const Eigen::Isometry3d there = to_isometry(motion);
    return (mean_misfit(view_, points_from_, to_, there) +
            mean_misfit(view_, points_to_, from_, there.inverse())) /
           2;
  }

 private:
  const PlatformLook& view_;
  DepthFrame from_;
  DepthFrame to_;
  Points points_from_;
  Points points_to_;
};

/// A motion, and the misfit of the frames for it.
struct Candidate {
  PlanarMotion motion = {};
  double disagreement = 0;
};

Candidate best_rotation(const FramePair& frames, const AngleRange& range) {
  Candidate best{.disagreement = 1};
  for (double deg = range.min_deg; deg <= range.max_deg; deg += coarse_step_deg) {
    const PlanarMotion motion{.deg = deg};
    if (const double value = frames.disagreement(motion); value < best.disagreement) {
      best = {.motion = motion, .disagreement = value};
    }
  }
  return best;
}

/// Refines a candidate by pattern search (Hooke and Jeeves 1961).
/// @param step      the first steps; a member that is 0 is not searched
/// @param smallest  the search ends when its steps are this share of the first ones
Candidate refined(const FramePair& frames, Candidate best, PlanarMotion step, double smallest) {
  for (double scale = 1; scale > smallest;) {
    bool is_better = false;
    for (const double by : {-scale, scale}) {
      for (const PlanarMotion& along :
           {PlanarMotion{.deg = step.deg}, PlanarMotion{.x = step.x}, PlanarMotion{.y = step.y}}) {
        const PlanarMotion motion{.deg = best.motion.deg + by * along.deg,
                                  .x = best.motion.x + by * along.x,
                                  .y = best.motion.y + by * along.y};
        if (const double value = frames.disagreement(motion); value < best.disagreement) {
          best = {.motion = motion, .disagreement = value};
          is_better = true;
        }
      }
    }
    if (!is_better) {
      scale /= 2;
    }
  }
  return best;
}

/// The misfits of some rotations, each of which is refined before.
template <typename Refine>
std::vector<double> misfits(const FramePair& frames, std::span<const double> degs, Refine refine) {
  std::vector<double> found;
  if (frames.see_an_object()) {
    for (const double deg : degs) {
      const PlanarMotion motion{.deg = deg};
      found.push_back(
          refine({.motion = motion, .disagreement = frames.disagreement(motion)}).disagreement);
    }
  }
  return found;
}

}  // namespace

std::optional<SeenRotation> seen_rotation(const PlatformLook& view, const DepthFrame& from,
                                          const DepthFrame& to, const AngleRange& range) {
  const FramePair frames(view, from, to);
  if (!frames.see_an_object()) {
    return std::nullopt;
  }
  const Candidate best = refined(frames, best_rotation(frames, range),
                                 {.deg = 2, .x = 0.004, .y = 0.004}, min_step_deg / 2);
  const auto beside = [&](double deg) {
    PlanarMotion motion = best.motion;
    motion.deg += deg;
    return frames.disagreement(motion);
  };
  const double mean_beside = (beside(-beside_deg) + beside(beside_deg)) / 2;
  return SeenRotation{.deg = best.motion.deg,
                      .sharpness = (mean_beside - best.disagreement) / best.disagreement};
}

std::vector<double> misfits_at(const PlatformLook& view, const DepthFrame& from,
                               const DepthFrame& to, std::span<const double> degs) {
  return misfits(FramePair(view, from, to), degs,
                 [](const Candidate& as_it_is) { return as_it_is; });
}

std::vector<double> misfits_about_any_axis(const PlatformLook& view, const DepthFrame& from,
                                           const DepthFrame& to, std::span<const double> degs) {
  const FramePair frames(view, from, to);
  return misfits(frames, degs, [&](const Candidate& candidate) {
    return refined(frames, candidate, {.x = 0.004, .y = 0.004}, 0.1);
  });
}

}  // namespace octurn
