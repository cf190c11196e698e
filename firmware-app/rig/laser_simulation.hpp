#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

// The interface between the program and its simulator of a camera with line lasers, which is a
// module: only a program that simulates such a rig loads it.

namespace octurn {

/// The true geometry of a camera with line lasers in front of a turning platform.
struct LaserSimulation {
  std::string mesh_file = {};  ///< STL in millimetres, Z up; empty: the simulator's own object
  std::uint32_t seed = 1;      ///< of noise and speckle: same seed, same pictures
  Intrinsics lens = {};        ///< of the camera
  double k1 = 0;               ///< radial distortion, as in `LaserCamera`
  double k2 = 0;
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  std::vector<Laser> lasers = {};                                          ///< all have sources
};

/// A grey picture and its colours.
struct ColourExposure {
  Picture picture = {};
  std::vector<Rgb> colours = {};  ///< their luminance is the picture's, except for rounding
};

/// Takes the pictures of a simulated camera. Used by one thread at a time.
class LaserSimulator {
 public:
  LaserSimulator() = default;
  virtual ~LaserSimulator() = default;
  LaserSimulator(const LaserSimulator&) = delete;
  LaserSimulator& operator=(const LaserSimulator&) = delete;

  /// Turns the object over. @param pose  number of the pose; 0 is the initial one
  virtual void set_object_pose(int pose) = 0;

  /// Takes a picture of the lens's size.
  /// @param angle  of the platform, radians, counter-clockwise seen from above
  /// @param lit    index of the laser that is on; nothing: all are off
  virtual Picture expose(double angle, std::optional<std::size_t> lit) = 0;

  /// The same with colours.
  virtual ColourExposure expose_in_colour(double angle, std::optional<std::size_t> lit) = 0;

  /// Takes a picture of a printed board that is moved in front of the camera. The board is held
  /// still for some pictures in each of several poses.
  /// @param number  index of the picture since the board appeared
  virtual Picture expose_board(int number) = 0;
};

/// The interface of the module libOcturnLaserSimulator, its symbol `octurn_laser_simulator`.
struct LaserSimulatorModule {
  /// @throws Error "mesh-malformed"
  std::unique_ptr<LaserSimulator> (*make)(const LaserSimulation& simulation) = nullptr;
};

}  // namespace octurn
