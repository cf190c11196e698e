#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "octurn/scan_folder.hpp"
#include "rig/laser_simulation.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/placed_object.hpp"
#include "simulator/rasterise.hpp"

namespace octurn {

/// The light of a line laser: a fan in its plane, 100 degrees wide, and its shadow map.
class LaserFan {
 public:
  /// @param laser   has a source
  /// @param target  point at which the fan's middle is aimed, metres, the laser's frame
  LaserFan(const Laser& laser, const Eigen::Vector3d& target);

  /// Adds a mesh that stops the light.
  /// @param sensor_from_mesh  mesh's frame to the laser's frame, metres
  void add(const Mesh& mesh, const Eigen::Isometry3d& sensor_from_mesh);

  /// Whether the light reaches a point in the laser's plane, metres, the laser's frame.
  bool reaches(const Eigen::Vector3d& point) const;

 private:
  Eigen::Isometry3d fan_from_sensor_;  // X across the plane, Z to the target
  InverseDepth shadow_map_;            // of the first surface along each ray of the fan
};

/// A camera that looks at a turning platform and its object, in the light of a room and of line
/// lasers.
///
/// A laser's line has a Gaussian profile, 0.8 mm wide (1/e^2), which is integrated over a pixel's
/// area and blurred by the lens. Surfaces are Lambertian. A line is visible where both the camera
/// and the laser's own rays reach the surface. The object has checks of 8 mm of two shades, and its
/// hue makes one turn about its axis. There are speckle, shot and read noise, and a lamp that
/// flickers by 2 % from picture to picture. Scattered light, gloss and lens distortion are not
/// simulated.
class LaserScene {
 public:
  explicit LaserScene(const LaserSimulation& simulation);

  // As of `LaserSimulator`.
  void set_object_pose(int pose);
  Picture expose(double angle, std::optional<std::size_t> lit);
  ColourExposure expose_in_colour(double angle, std::optional<std::size_t> lit);

 private:
  /// The surface at a pixel.
  struct Patch {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   // metres, optical frame
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of length one, towards the camera
    double albedo = 0;
    /// Colour difference of blue and of red, relative to the luminance (U and V of BT.601).
    Eigen::Vector2f tint = Eigen::Vector2f::Zero();
    bool is_seen = false;
  };

  void render(double angle);
  std::vector<float> levels(double angle, std::optional<std::size_t> lit);
  Picture to_picture(const std::vector<float>& levels) const;
  Patch patch(int u, int v) const;
  double slope(std::size_t pixel, std::ptrdiff_t step, bool is_first, bool is_last) const;
  void add_line(std::size_t laser, std::vector<float>& light) const;
  double line_light(std::size_t laser, const Patch& patch) const;

  LaserSimulation simulation_;
  PlacedObject object_;
  WhiteNoise noise_;
  InverseDepth background_;
  std::vector<LaserFan> fans_at_rest_ = {};  // without the object
  std::vector<LaserFan> fans_ = {};
  InverseDepth seen_ = {};
  std::vector<float> room_light_ = {};       // grey levels
  std::vector<Eigen::Vector2f> tints_ = {};  // of the pixels
  Eigen::Isometry3d object_from_sensor_ = Eigen::Isometry3d::Identity();
  double angle_ = 0;
  std::uint32_t pictures_ = 0;
};

}  // namespace octurn
