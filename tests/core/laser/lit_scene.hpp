#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "support/random.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// Balls on the platform, in the object's frame, metres. Rays are intersected analytically, so that
/// the scene shares neither code nor error with the library.
struct LitScene {
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  struct Hit {
    double distance = 0;  // in lengths of the ray's direction
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  };

  std::vector<Ball> balls = {};
  double platform_radius = 0.15;

  std::optional<Hit> cast(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    std::optional<Hit> nearest;
    const auto take = [&](double distance, const Eigen::Vector3d& normal) {
      if (distance > 1e-7 && (!nearest || distance < nearest->distance)) {
        nearest = {.distance = distance, .normal = normal};
      }
    };
    if (along.z() != 0) {
      const double distance = -from.z() / along.z();
      if ((from + distance * along).norm() < platform_radius) {
        take(distance, Eigen::Vector3d::UnitZ());
      }
    }
    for (const Ball& ball : balls) {
      const Eigen::Vector3d to = from - ball.centre;
      const double a = along.squaredNorm();
      const double b = to.dot(along);
      const double root = b * b - a * (to.squaredNorm() - ball.radius * ball.radius);
      if (root > 0) {
        const double distance = (-b - std::sqrt(root)) / a;
        take(distance, (to + distance * along).normalized());
      }
    }
    return nearest;
  }

  /// Signed distance of a point to the nearest surface, metres, positive outside.
  double distance(const Eigen::Vector3d& point) const {
    double least = std::abs(point.z());
    for (const Ball& ball : balls) {
      const double to_ball = (point - ball.centre).norm() - ball.radius;
      least = std::abs(to_ball) < std::abs(least) ? to_ball : least;
    }
    return least;
  }
};

/// Platform from camera: the camera stands in front and looks down by 25 degrees (optical X right,
/// Y down, Z forward).
inline Eigen::Isometry3d laser_rig_pose() {
  Eigen::Matrix3d upright;
  upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(radians_from_degrees(-25), Eigen::Vector3d::UnitX()) * upright;
  pose.translation() = Eigen::Vector3d(0, -0.26, 0.15);
  return pose;
}

/// A laser beside the camera that lights a vertical plane close to the axis.
/// @param off  distance of the plane from the axis, metres
inline Laser upright_laser(const std::string& name, double azimuth_deg, double off) {
  const double azimuth = radians_from_degrees(azimuth_deg);
  const Eigen::Vector3d normal(std::cos(azimuth), std::sin(azimuth), 0);  // platform's frame
  const Eigen::Vector3d source(0.3 * std::sin(azimuth), -0.3 * std::cos(azimuth), 0.12);
  const Eigen::Isometry3d pose = laser_rig_pose();
  return {.name = name,
          .normal = pose.linear().transpose() * normal,
          .distance = off - normal.dot(pose.translation()),
          .source = pose.inverse() * Eigen::Vector3d(source + normal * (off - normal.dot(source)))};
}

/// A scan by two lasers with small pictures. The shots name their pictures; no file exists yet.
inline Scan laser_rig(int stops) {
  Scan scan{.sensor_name = "test",
            .intrinsics = {.width = 200, .height = 150, .fx = 330, .fy = 330, .cx = 99.5, .cy = 90},
            .laser = LaserCamera{.k1 = -0.08,
                                 .k2 = 0.01,
                                 .lasers = {upright_laser("left", -30, 0.0006),
                                            upright_laser("right", 28, -0.0004)}},
            .platform_from_sensor = laser_rig_pose(),
            .clip = {.min = {-0.06, -0.06, 0.002}, .max = {0.06, 0.06, 0.1}}};
  for (int i = 0; i < stops; ++i) {
    const std::string stem = "snapshots/" + std::to_string(i);
    scan.shots.push_back({.pictures = {stem + "-dark.png", stem + "-left.png", stem + "-right.png"},
                          .angle = i * 2 * std::numbers::pi / stops});
  }
  return scan;
}

/// Draws pictures of a scene as a laser rig sees it.
class LaserPictures {
 public:
  LaserPictures(const Scan& scan, LitScene scene, double noise)
      : scan_(scan), scene_(std::move(scene)), noise_(noise) {}

  /// @param laser  null for the dark picture
  std::vector<std::uint8_t> draw(double angle, const Laser* laser) {
    const Intrinsics& lens = scan_.intrinsics;
    const Eigen::Isometry3d pose = object_from_sensor(scan_.platform_from_sensor, angle);
    std::vector<std::uint8_t> samples;
    for (int v = 0; v < lens.height; ++v) {
      for (int u = 0; u < lens.width; ++u) {
        double light = 6;  // room light, grey levels
        if (laser != nullptr && is_near(*laser, pose, u, v)) {
          for (int part = 0; part < parts; ++part) {
            light += of_line(*laser, pose, u + (part + 0.5) / parts - 0.5, v) / parts;
          }
        }
        light += noise_ * 3.5 * (random_.uniform() - 0.5);  // 3.5 is about sqrt(12): deviation 1
        samples.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L)));
      }
    }
    return samples;
  }

 private:
  static constexpr int parts = 3;             // samples across a pixel
  static constexpr double half_width = 8e-4;  // metres, to 1/e^2 of the peak

  /// The first surface on a pixel's ray. `point` receives it in the object's frame.
  std::optional<LitScene::Hit> cast(const Eigen::Isometry3d& pose, double u, double v,
                                    Eigen::Vector3d& point) const {
    const Intrinsics& lens = scan_.intrinsics;
    const double xd = (u - lens.cx) / lens.fx;
    const double yd = (v - lens.cy) / lens.fy;
    double x = xd;
    double y = yd;
    for (int i = 0; i < 10; ++i) {  // fixed-point iteration
      const double square = x * x + y * y;
      const double factor = 1 + scan_.laser->k1 * square + scan_.laser->k2 * square * square;
      x = xd / factor;
      y = yd / factor;
    }
    const Eigen::Vector3d along = pose.linear() * Eigen::Vector3d(x, y, 1);
    const auto hit = scene_.cast(pose.translation(), along);
    if (hit) {
      point = pose.translation() + hit->distance * along;
    }
    return hit;
  }

  /// Whether the laser line may be visible in a pixel.
  bool is_near(const Laser& laser, const Eigen::Isometry3d& pose, int u, int v) const {
    Eigen::Vector3d point;
    return cast(pose, u, v, point) &&
           std::abs(laser.normal.dot(pose.inverse() * point) - laser.distance) < 0.008;
  }

  double of_line(const Laser& laser, const Eigen::Isometry3d& pose, double u, double v) const {
    Eigen::Vector3d point;
    const auto hit = cast(pose, u, v, point);
    if (!hit) {
      return 0;
    }
    const double off = laser.normal.dot(pose.inverse() * point) - laser.distance;
    if (std::abs(off) > 3 * half_width) {
      return 0;
    }
    const Eigen::Vector3d source = pose * *laser.source;
    const Eigen::Vector3d from_source = point - source;
    const double lambert = -from_source.normalized().dot(hit->normal);
    const auto lit = scene_.cast(source, from_source);
    if (lambert <= 0 || (lit && lit->distance < 0.999)) {
      return 0;
    }
    return 200 * lambert * std::exp(-2 * off * off / (half_width * half_width));
  }

  const Scan& scan_;
  LitScene scene_;
  double noise_;
  Random random_{7};
};

/// Writes a scan folder whose pictures show the scene.
inline Scan write_laser_scan(const std::filesystem::path& folder, const LitScene& scene,
                             int stops) {
  const Scan scan = laser_rig(stops);
  LaserPictures pictures(scan, scene, 0.5);
  std::filesystem::create_directories(folder / "snapshots");
  for (const Shot& shot : scan.shots) {
    for (std::size_t i = 0; i < shot.pictures.size(); ++i) {
      const Laser* laser = i == 0 ? nullptr : &scan.laser->lasers[i - 1];
      const auto png = encode_grey_png(scan.intrinsics.width, scan.intrinsics.height,
                                       pictures.draw(shot.angle, laser));
      put(folder / shot.pictures[i], {reinterpret_cast<const char*>(png.data()), png.size()});
    }
  }
  write_scan(folder, scan);
  return scan;
}

}  // namespace octurn
