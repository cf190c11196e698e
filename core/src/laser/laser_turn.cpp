#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"
#include "laser/draw_triangle.hpp"
#include "laser/line_strip.hpp"
#include "octurn/register.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t max_depth_views = 24;  // one every 15 degrees is enough for registration
constexpr int max_width = 480;               // pixels of a view, 0.3 mm each on an object of 10 cm
constexpr double depth_unit = 0.00002;       // metres

// Maximum platform angle between a view and a line that is drawn in it, radians. From a larger
// angle rays may pass through surface that no line met, and would mark it as free space.
constexpr double max_view_angle = std::numbers::pi / 4;

/// Whether a line seen at one platform angle is drawn in the view at another.
bool is_near(double angle, double other) {
  return std::abs(std::remainder(angle - other, 2 * std::numbers::pi)) <= max_view_angle;
}

/// The intrinsics of the same camera with pixels `factor` times as wide.
Intrinsics coarser(const Intrinsics& lens, int factor) {
  return {.width = lens.width / factor,
          .height = lens.height / factor,
          .fx = lens.fx / factor,
          .fy = lens.fy / factor,
          .cx = (lens.cx + 0.5) / factor - 0.5,
          .cy = (lens.cy + 0.5) / factor - 0.5,
          .depth_unit = depth_unit};
}

/// A depth buffer seen from the camera's pose at one stop.
class SurfaceView {
 public:
  SurfaceView(const Intrinsics& lens, const Isometry3d& object_from_sensor)
      : lens_(lens),
        sensor_from_object_(object_from_sensor.inverse()),
        eye_(object_from_sensor.translation()),
        depth_(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height), none) {
  }

  /// @param seen_from  metres, object's frame: the camera that saw the strip
  void draw(const LineStrip& strip, const Vector3d& seen_from) {
    for (const LineStrip::Triangle& triangle : strip.to_next) {
      std::array<Vector3d, 3> points;
      std::ranges::transform(triangle, points.begin(), [&](std::uint32_t point) -> Vector3d {
        return strip.points[point].cast<double>();
      });
      const Vector3d normal = (points[1] - points[0]).cross(points[2] - points[0]);
      const bool is_back = normal.dot(seen_from - points[0]) * normal.dot(eye_ - points[0]) <= 0;
      draw(points, is_back);
    }
  }

  /// A pixel has no reading where the nearest surface is seen from behind.
  DepthFrame frame() const {
    DepthFrame frame{.width = lens_.width, .height = lens_.height};
    frame.depth.reserve(depth_.size());
    for (const float depth : depth_) {
      const double units = std::round(static_cast<double>(depth) / depth_unit);
      const bool is_reading = units > 0 && units <= std::numeric_limits<std::uint16_t>::max();
      frame.depth.push_back(is_reading ? static_cast<std::uint16_t>(units) : std::uint16_t{0});
    }
    return frame;
  }

 private:
  static constexpr float none = std::numeric_limits<float>::infinity();

  void draw(const std::array<Vector3d, 3>& points, bool is_back) {
    std::array<ImageCorner, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d p = sensor_from_object_ * points[i];
      if (!(p.z() > nearest_z)) {
        return;
      }
      const Eigen::Vector2d pixel = project(lens_, p);
      corners[i] = {.u = pixel.x(), .v = pixel.y(), .inverse_depth = 1 / p.z()};
    }
    visit_pixels(corners, lens_.width, lens_.height,
                 [&](int u, int v, const std::array<double, 3>& shares) {
                   const auto z = static_cast<float>(1 / inverse_depth_at(corners, shares));
                   float& nearest =
                       depth_[static_cast<std::size_t>(v) * static_cast<std::size_t>(lens_.width) +
                              static_cast<std::size_t>(u)];
                   if (z < std::abs(nearest)) {
                     nearest = is_back ? -z : z;
                   }
                 });
  }

  Intrinsics lens_;
  Isometry3d sensor_from_object_;
  Vector3d eye_;              // metres, object's frame
  std::vector<float> depth_;  // metres; negative where the surface is seen from behind
};

}  // namespace

RegistrationTurn laser_turn(const std::filesystem::path& folder, const Scan& scan,
                            const std::stop_token& stop) {
  const std::size_t stops = scan.shots.size();
  const int factor = (scan.intrinsics.width + max_width - 1) / max_width;
  RegistrationTurn turn{.intrinsics = coarser(scan.intrinsics, factor),
                        .platform_from_sensor = model_pose(scan),
                        .clip = scan.clip};
  std::vector<SurfaceView> views;
  for (std::size_t i = 0; i < std::min(stops, max_depth_views); ++i) {
    turn.angles.push_back(scan.shots[i * stops / std::min(stops, max_depth_views)].angle);
    views.emplace_back(turn.intrinsics,
                       object_from_sensor(turn.platform_from_sensor, turn.angles.back()));
  }
  const LaserLines lines(folder, scan);
  for (std::size_t i = 0; i < stops; ++i) {
    throw_if_stopped(stop);
    const Snapshot snapshot = lines.snapshot(i);
    for (const LineStrip& strip : snapshot.strips) {
      for (std::size_t k = 0; k < views.size(); ++k) {
        if (is_near(scan.shots[i].angle, turn.angles[k])) {
          views[k].draw(strip, snapshot.object_from_sensor.translation());
        }
      }
    }
  }
  const auto frames = std::make_shared<std::vector<DepthFrame>>();
  for (const SurfaceView& view : views) {
    frames->push_back(view.frame());
  }
  turn.read = [frames](std::size_t i) { return (*frames)[i]; };
  return turn;
}

}  // namespace octurn
