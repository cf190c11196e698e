#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "octurn/snapshot.hpp"
#include "simulator/rasterise.hpp"

namespace octurn {

/// The optics of one Kinect: no real one has its data sheet's.
///
/// Published calibrations have focal lengths of 570 to 600 pixels, principal points up to 20 pixels
/// off, k1 of the infrared camera from -0.05 to -0.26, and depths that are a per cent or two off.
/// @param unit  0: the data sheet's. 1: 590.5 pixels, 332 / 246, k1 -0.06, depths 1.2 % short.
///              Others are drawn at random from the spread of published ones
SensorOptics optics_of_unit(std::uint32_t unit);

/// The picture of a pinhole camera from which a `SensorView` takes the sensor's own: that, and
/// a margin for what distortion brings into view.
Intrinsics pinhole_of(const SensorOptics& optics);

/// The view of a sensor with its own optics.
class SensorView {
 public:
  explicit SensorView(const SensorOptics& optics);

  const SensorOptics& optics() const { return optics_; }

  /// The inverse depths that the sensor reports, 640 x 480, of a surface that the pinhole camera
  /// sees. Between pixels of one surface they are interpolated.
  /// @param pinhole  the picture of `pinhole_of(optics())`
  InverseDepth of(const InverseDepth& pinhole) const;

 private:
  SensorOptics optics_;
  std::vector<Eigen::Vector2f> places_;  // of the pixels in the pinhole picture; empty: the same
};

}  // namespace octurn
