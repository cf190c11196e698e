#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
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

/// The halo of a laser's line on a surface: of the line's peak, the shares 0, 5, 10, 20, 40 and 60
/// pixels to each side, between which they are interpolated. Measured on a green laser by a webcam
/// of 640 x 480.
struct Halo {
  std::array<double, 6> left = {};
  std::array<double, 6> right = {};

  double share(double off) const {
    constexpr std::array<double, 6> at{0, 5, 10, 20, 40, 60};
    const auto& shares = off < 0 ? left : right;
    for (std::size_t i = 1; i < at.size(); ++i) {
      if (std::abs(off) <= at[i]) {
        const double part = (std::abs(off) - at[i - 1]) / (at[i] - at[i - 1]);
        return std::lerp(shares[i - 1], shares[i], part);
      }
    }
    return 0;
  }
};

inline constexpr Halo on_plastic{.left = {0.1, 0.06, 0.02, 0.02, 0.01, 0},
                                 .right = {0.07, 0.04, 0.01, 0.01, 0.005, 0}};
inline constexpr Halo on_plaster{.left = {0.26, 0.18, 0.08, 0.03, 0.01, 0},
                                 .right = {0.33, 0.23, 0.08, 0.02, 0.01, 0}};
inline constexpr Halo on_paper{.left = {0.46, 0.38, 0.3, 0.28, 0.27, 0},
                               .right = {0.44, 0.34, 0.24, 0.13, 0.03, 0}};
inline constexpr Halo on_sponge{.left = {1, 0.67, 0.39, 0.25, 0.13, 0},
                                .right = {1, 0.61, 0.32, 0.14, 0.04, 0}};

/// What real light does besides drawing lines; the defaults are none of it.
struct StrayLight {
  double exposure = 1;  ///< of the line: 2 saturates its middle
  Halo halo = {};
  /// Grey levels of the light that a lit object throws on the white squares of a platform that is
  /// printed with squares of 9 mm.
  double indirect = 0;
};

/// Draws pictures of a scene as a laser rig sees it.
class LaserPictures {
 public:
  LaserPictures(const Scan& scan, LitScene scene, double noise, const StrayLight& stray = {})
      : scan_(scan), scene_(std::move(scene)), noise_(noise), stray_(stray) {}

  /// @param laser  null for the dark picture
  std::vector<std::uint8_t> draw(double angle, const Laser* laser) {
    const Intrinsics& lens = scan_.intrinsics;
    const Eigen::Isometry3d pose = object_from_sensor(scan_.platform_from_sensor, angle);
    std::vector<Row> rows(static_cast<std::size_t>(lens.height));
    std::vector<Peak> peaks(rows.size());
    for (int v = 0; v < lens.height; ++v) {
      Row& row = rows[static_cast<std::size_t>(v)];
      row.assign(static_cast<std::size_t>(lens.width), 0.0);
      for (int u = 0; laser != nullptr && u < lens.width; ++u) {
        if (is_near(*laser, pose, u, v)) {
          for (int part = 0; part < parts; ++part) {
            row[static_cast<std::size_t>(u)] +=
                stray_.exposure * of_line(*laser, pose, u + (part + 0.5) / parts - 0.5, v) / parts;
          }
        }
      }
      peaks[static_cast<std::size_t>(v)] = find_peak(row);
    }
    std::vector<std::uint8_t> samples;
    for (int v = 0; v < lens.height; ++v) {
      Row& row = rows[static_cast<std::size_t>(v)];
      add_halo(row, peaks, v);
      add_indirect_light(row, pose, v, peaks[static_cast<std::size_t>(v)].level);
      for (const double line : row) {
        const double light = room_light + line + noise_ * 3.5 * (random_.uniform() - 0.5);
        samples.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L)));
      }
    }
    return samples;
  }

 private:
  static constexpr double room_light = 6;     // grey levels
  static constexpr int parts = 3;             // samples across a pixel
  static constexpr double half_width = 8e-4;  // metres, to 1/e^2 of the peak

  using Row = std::vector<double>;

  /// The brightest pixel of a row of line light, and the centre of the light around it.
  struct Peak {
    double level = 0;
    double column = 0;
  };

  static Peak find_peak(const Row& row) {
    const auto peak = std::ranges::max_element(row);
    if (*peak <= 0) {
      return {};
    }
    const auto first = peak - std::min<std::ptrdiff_t>(3, peak - row.begin());
    const auto end = peak + std::min<std::ptrdiff_t>(4, row.end() - peak);
    double light = 0;
    double moment = 0;
    for (auto at = first; at != end; ++at) {
      light += *at;
      moment += *at * static_cast<double>(at - row.begin());
    }
    return {.level = *peak, .column = moment / light};
  }

  /// Adds the halo of a row's line and of those around it: light scatters along the line, too.
  void add_halo(Row& row, const std::vector<Peak>& peaks, int v) const {
    constexpr int reach = 4;  // rows
    for (int from = std::max(v - reach, 0);
         from <= v + reach && from < static_cast<int>(peaks.size()); ++from) {
      const Peak& peak = peaks[static_cast<std::size_t>(from)];
      const double weight = (1 + reach - std::abs(from - v)) / std::pow(1 + reach, 2);
      for (std::size_t u = 0; peak.level > 0 && u < row.size(); ++u) {
        const double off = static_cast<double>(u) - peak.column;
        row[u] += weight * peak.level * stray_.halo.share(off);
      }
    }
  }

  /// @param level  of the row's line
  void add_indirect_light(Row& row, const Eigen::Isometry3d& pose, int v, double level) const {
    for (std::size_t u = 0; stray_.indirect > 0 && level > 0 && u < row.size(); ++u) {
      Eigen::Vector3d point;
      if (cast(pose, static_cast<double>(u), v, point) && std::abs(point.z()) < 1e-6) {
        const Eigen::Vector2d cell = (point.head<2>() / 0.009).array().floor();
        row[u] += std::fmod(std::abs(cell.sum()), 2) == 0 ? stray_.indirect : 0;
      }
    }
  }

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
  StrayLight stray_;
  Random random_{7};
};

/// Writes a scan folder whose pictures show the scene.
inline Scan write_laser_scan(const std::filesystem::path& folder, const LitScene& scene, int stops,
                             const StrayLight& stray = {}) {
  const Scan scan = laser_rig(stops);
  LaserPictures pictures(scan, scene, 0.5, stray);
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
