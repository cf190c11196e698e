#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "simulator/infrared_board.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/scene.hpp"
#include "simulator/sensor_pattern.hpp"
#include "simulator/surface.hpp"

namespace octurn {

/// A Kinect v1 in front of a scene: 11-bit readings with noise, without depth at some edges, on
/// grazing surfaces and in the last 8 columns.
///
/// Its errors have three parts: temporal noise, new in every frame; noise of the projected speckles
/// that fall on a surface, constant while the scene stands still; and the sensor's fixed pattern,
/// which never changes and depends on distance.
///
/// Planes of 40 x 40 pixels in eight frames of a real Kinect v1 and in simulated ones
/// (kinect_noise_test compares them):
///
///                                                  real                    simulated
///     residual at 0.65, 0.75, 0.85 m, readings     0.85 0.81 0.71          0.88 0.81 0.78
///     correlation 1, 2, 4, 6 pixels along rows     0.72 0.59 0.40 0.23     0.66 0.58 0.40 0.23
///     and along columns                            0.50 0.26 0.01 -0.08    0.49 0.24 -0.01 -0.01
///     share of upper edges that lose no pixel      0.89                    0.83
///
/// Depth is quantised by the 11-bit readings. On the platform at 0.65 m the error of one frame is
/// 1.12 mm (root mean square), of the mean of ten 0.57 mm and of thirty 0.51 mm. The fixed pattern
/// adds a millimetre.
class SimulatedKinect {
 public:
  /// @param scene    in front of the sensor
  /// @param seed     of noise and pattern
  /// @param noise    factor of a real Kinect's; 0: readings are only rounded, and depth is missing
  ///                 only in shadow and in the last columns
  /// @param pattern  factor of a real Kinect's fixed pattern; 0: none
  SimulatedKinect(Scene scene, std::uint32_t seed, double noise, double pattern);

  /// Turns the sensor to a wall, and away from its scene. @param distance  metres; 0: back again
  void turn_to_wall(double distance);

  /// Shows a printed board before the sensor. @param hold  as of `infrared_hold`; 0: puts it away
  void show_board(int hold);

  /// Turns the object over. @param pose  as of `platform_from_object`
  void set_object_pose(int pose);

  /// Takes one frame: 640 x 480 depths in tenths of a millimetre, 0 for none.
  /// @param angle  of the platform, radians
  /// @param frame  index of the frame, which determines its noise
  void expose(double angle, std::uint32_t frame, std::span<std::uint16_t> depth);

  /// Takes one infrared picture: 640 x 480 grey levels. Without a board it shows an empty room.
  void expose_infrared(std::uint32_t frame, std::span<std::uint8_t> picture);

 private:
  /// A pixel's reading and its noise while the platform stands still.
  struct Pixel {
    float reading = 0;         // before it is rounded
    float spread = 0;          // standard deviation from frame to frame, over NoiseField::one
    float loss_threshold = 0;  // noise above which the pixel has no depth, times NoiseField::one
  };

  struct Rectangle {
    int left = 0;
    int top = 0;
    int right = 0;  // one past the last
    int bottom = 0;
  };

  void look_again();
  Rectangle changed_from(const InverseDepth& before) const;
  void update_pixels(const Rectangle& part);
  InverseDepth with_ragged_edges(const Rectangle& part) const;
  Pixel noisy(const Surface& surface, int u, int v) const;

  Scene scene_;
  std::uint32_t seed_;
  float noise_;
  NoiseField field_;
  SensorPattern pattern_;
  std::vector<std::uint16_t> depth_table_;  // depth of each reading
  double angle_ = 0;
  double wall_ = 0;                             // metres; 0: it looks at its scene
  int board_ = 0;                               // number of the hold; 0: there is no board
  std::optional<InfraredBoard> infrared_ = {};  // once a picture is taken
  InverseDepth lit_;
  std::vector<Pixel> pixels_;
};

/// The depth scale of a Kinect v1: an 11-bit reading that is affine in inverse depth,
/// z = 345489 / (1089.40 - reading) mm. The constants fit 510 of the 512 distinct depths in 110
/// frames of real sensors. 345489 mm is 8 f b: eighths of a pixel, f = 575.8 pixels, b = 75 mm.
inline constexpr float reading_at_infinity = 1089.40F;
inline constexpr float readings_times_metres = 345.489F;

/// The reading of a pixel without depth.
inline constexpr int no_reading = 2047;

/// @param inverse_depth  1/m  @return the reading before it is rounded
constexpr float to_reading(float inverse_depth) {
  return reading_at_infinity - readings_times_metres * inverse_depth;
}

/// The depth of each of the 2048 readings, tenths of a millimetre; 0 for those nearer than the
/// sensor's limit (0.45 m), farther than 16 bits of tenths of a millimetre reach, or no reading.
std::vector<std::uint16_t> depth_of_readings();

}  // namespace octurn
