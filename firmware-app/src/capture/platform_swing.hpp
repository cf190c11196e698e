#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <span>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Geometry of a sensor that looks at an object on the platform.
struct PlatformLook {
  Intrinsics intrinsics = {};
  Eigen::Isometry3d platform_from_sensor = {};  ///< metres; errors of some millimetres are allowed
  Box clip = {};                                ///< around the object, platform frame, metres
};

/// Whether the platform turned while frames were taken of it: whether a frame shows the object
/// turned from its place in the first by more than the noise explains: by half a degree to one, for
/// an object of 8 cm at 0.7 m.
///
/// The turn is the one that explains the differences of depth best, by the depth's change with the
/// angle at each pixel: a linear least-squares fit, whose residuals tell the noise. An object that
/// looks the same from all sides cannot be seen to turn, and does no harm if it does.
///
/// @param frames  of a platform that swings by a few degrees at most, in their order
bool is_swinging(const PlatformLook& look, std::span<const DepthFrame> frames);

/// The time that a platform needs to stand still after its moves, as the last ones had it. In
/// frames, as they are the clock of what is seen.
class Settling {
 public:
  /// Frames to leave out after the next move.
  int frames() const { return frames_; }

  /// The same as time, at a Kinect's 30 frames a second.
  std::chrono::duration<double> time() const {
    return std::chrono::duration<double>(frames_ / 30.0);
  }

  /// Reports a move. @param frames  after which the platform stood still
  void stood_after(int frames);

 private:
  int frames_ = 0;
};

/// The most frames to wait for a platform that does not stand still, 3 s of a Kinect's.
inline constexpr int max_settling_frames = 90;

}  // namespace octurn
