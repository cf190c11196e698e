#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rig/laser_simulation.hpp"
#include "simulator/laser_fan.hpp"
#include "simulator/placed_object.hpp"
#include "simulator/rasterise.hpp"
#include "simulator/white_noise.hpp"

namespace octurn {

/// A camera that looks at a turning platform and its object, in the light of a room and of line
/// lasers.
///
/// A laser's line has a Gaussian profile, 0.8 mm wide (1/e^2), which a pixel integrates and the
/// lens blurs. Lambert's law holds. Neither what the camera does not see nor what the laser's own
/// rays do not reach is lit. There are speckle, an object with checks of 8 mm of two shades, shot
/// and read noise, and a lamp that flickers by 2 % from picture to picture. There is no light that
/// scatters, and no gloss.
class LaserScene final : public LaserSimulator {
 public:
  explicit LaserScene(const LaserSimulation& simulation);

  void lay_object(int pose) override;
  Picture expose(double angle, std::optional<std::size_t> lit) override;

 private:
  /// What the camera sees at a pixel.
  struct Patch {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   // metres, optical frame
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of length one, towards the camera
    double albedo = 0;
    bool is_seen = false;
  };

  void look(double angle);
  Patch patch(int u, int v) const;
  double slope(std::size_t pixel, std::ptrdiff_t step, bool is_first, bool is_last) const;
  void add_line(std::size_t laser, std::vector<float>& light) const;
  double line_light(std::size_t laser, const Patch& patch) const;

  LaserSimulation simulation_;
  PlacedObject object_;
  WhiteNoise noise_;
  InverseDepth background_;
  std::vector<LaserFan> fans_at_rest_ = {};  // that meet what does not turn
  std::vector<LaserFan> fans_ = {};
  InverseDepth seen_ = {};
  std::vector<float> room_light_ = {};  // grey levels
  Eigen::Isometry3d object_from_sensor_ = Eigen::Isometry3d::Identity();
  double angle_ = 0;
  std::uint32_t pictures_ = 0;
};

}  // namespace octurn
