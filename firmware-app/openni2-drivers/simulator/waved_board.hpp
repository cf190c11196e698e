#pragma once

#include <Eigen/Core>
#include <vector>

#include "octurn/png.hpp"
#include "rig/laser_simulation.hpp"
#include "simulator/noise_field.hpp"

namespace octurn {

/// A printed board that is moved in front of a camera: 12 by 17 squares of 15 mm with a white
/// margin, in light that falls off to one side, before a grey room. It is held still for five
/// pictures and moves for two, through poses all over the picture that are tilted each way.
class WavedBoard {
 public:
  explicit WavedBoard(const LaserSimulation& simulation);

  /// @param number  index of the picture since the board appeared
  Picture picture(int number) const;

 private:
  LaserSimulation simulation_;
  WhiteNoise noise_;
  std::vector<Eigen::Vector2d> rays_ = {};  // of the pixels, row by row
};

}  // namespace octurn
