#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"
#include "rig/simulation.hpp"
#include "sensor/depth_sensor.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// A frame of a Kinect v1. Readings are computed back from depths, and rays from pixels, by the
/// published formulas and not by the simulator's code.
struct KinectFrame {
  DepthFrame frame = {};

  double depth(int u, int v) const {  // metres
    return metres_from_mm(frame.depth[static_cast<std::size_t>(v * 640 + u)] / 10.0);
  }
  bool is_seen(int u, int v) const {
    return frame.depth[static_cast<std::size_t>(v * 640 + u)] != 0;
  }
};

/// z = 345489 / (1089.40 - reading) mm, solved for the reading. @param depth  metres
inline double reading_of_depth(double depth) { return 1089.40 - 345489 / mm_from_metres(depth); }

/// The ray of a pixel in the optical frame, one metre deep.
inline Eigen::Vector3d ray_of(double u, double v) {
  return {(u - 320) / 575.8, (v - 240) / 575.8, 1};
}

/// The point of a pixel in the platform's frame at angle 0, metres.
inline Eigen::Vector3d point_at(const KinectFrame& frame, int u, int v) {
  return nominal_platform_from_sensor() * (frame.depth(u, v) * ray_of(u, v));
}

/// Turns the platform, and returns a frame that the sensor takes after that.
inline KinectFrame frame_at(DepthSensor& sensor, double angle) {
  sensor.show_angle(angle);
  const auto turned = std::chrono::steady_clock::now();
  for (;;) {
    TimedFrame timed = sensor.read({}).value();
    if (timed.time >= turned) {
      return {std::move(timed.frame)};
    }
  }
}

/// Opens a sensor, and returns its frame at an angle.
inline KinectFrame frame_of(const std::string& uri, double angle = 0) {
  const auto sensor = open_sensor(uri);
  return frame_at(*sensor, angle);
}

/// The URI of a simulated sensor that sees boxes, given in millimetres.
class BoxesOnPlatform {
 public:
  explicit BoxesOnPlatform(const std::vector<Eigen::AlignedBox3d>& boxes) {
    // Bits 0, 1 and 2 of a corner's index select its x, y and z.
    constexpr std::array<std::array<int, 4>, 6> sides = {
        {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
    std::string stl = "solid boxes\n";
    for (const Eigen::AlignedBox3d& box : boxes) {
      for (const auto& [a, b, c, d] : sides) {
        stl += facet(box, {a, b, c}) + facet(box, {a, c, d});
      }
    }
    put(folder_.path() / "boxes.stl", stl + "endsolid\n");
  }

  std::string uri(double noise = 0, double speed = 1) const {
    return simulation_uri({.mesh_file = folder_.path() / "boxes.stl",
                           .noise = noise,
                           .pattern = 0,
                           .misalignment = 0,
                           .speed = speed});
  }

 private:
  static std::string facet(const Eigen::AlignedBox3d& box, const std::array<int, 3>& corners) {
    std::string text = "facet normal 0 0 0\nouter loop\n";
    for (const int corner : corners) {
      const Eigen::Vector3d at = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      text += "vertex " + std::to_string(at.x()) + " " + std::to_string(at.y()) + " " +
              std::to_string(at.z()) + "\n";
    }
    return text + "endloop\nendfacet\n";
  }

  TemporaryFolder folder_;
};

}  // namespace octurn
