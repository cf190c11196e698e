#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "octurn/snapshot.hpp"
#include "simulator/noise_field.hpp"

namespace octurn {

/// How somebody holds the printed board before a Kinect: all over the picture, tilted each way, 0.5
/// to 0.75 m away.
/// @param number  of the hold, from 1; after the last one the first follows
/// @return optical frame from the board's frame of `printed_board.hpp`, lengths in squares
Eigen::Isometry3d infrared_hold(int number, const SensorOptics& optics);

/// A Kinect's infrared camera, which looks at a printed board or into a room without one. The
/// projector's dots, one in each 3 x 3 pixels and of unequal brightness, move with the depth of
/// what they fall on, and are brighter on what is near. There is little other light.
class InfraredBoard {
 public:
  InfraredBoard(const SensorOptics& optics, std::uint32_t seed);

  /// Takes a picture of 640 x 480 pixels.
  /// @param hold   as of `infrared_hold`; 0: there is no board
  /// @param frame  number of the frame, which determines its noise
  void expose(int hold, std::uint32_t frame, std::span<std::uint8_t> picture);

 private:
  void look_at(int hold);
  float light_of_dots(double u, double v) const;

  SensorOptics optics_;
  std::uint32_t seed_;
  WhiteNoise noise_;
  int hold_ = -1;
  std::vector<float> seen_ = {};  // grey levels without noise
};

}  // namespace octurn
