#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// What a depth sensor reads too much at each pixel, in inverse depth: a fixed pattern of its
/// lenses and its projector, which stays however many frames are averaged. It changes a little with
/// distance: at inverse depth q a pixel errs by what lies linearly between `near` and `far`.
///
/// docs/sensor-map.md has the file, and how a map is made.
struct SensorMap {
  int width = 0;                  ///< pixels, of the sensor's frames
  int height = 0;                 ///< pixels
  double near_inverse_depth = 0;  ///< 1/m, at which `near` holds
  double far_inverse_depth = 0;   ///< 1/m, at which `far` holds; less than the other
  std::vector<float> near = {};   ///< 1/m, width x height, row by row from the top left
  std::vector<float> far = {};    ///< the same; empty if the map is alike at every distance
  std::string serial = {};        ///< of the sensor; empty if it tells none
  std::string made = {};          ///< UTC, as in ISO 8601; empty if nobody said
  double before = 0;  ///< 1/m: root mean square of the walls' residuals, of 4 x 4 pixels
  double after = 0;   ///< the same with this map
};

/// A step of a Kinect v1's disparity in inverse depth, 1/m (z = 345.489 m / disparity). People know
/// a depth sensor's errors in it.
inline constexpr double disparity_unit = 1 / 345.489;

/// The frame without the sensor's own error. 0 stays 0; depths are rounded to the depth unit.
///
/// @param depth_unit  metres
/// @throws std::invalid_argument  if the map is of another size
DepthFrame corrected(DepthFrame frame, const SensorMap& map, double depth_unit);

/// A map as a PNG of 16-bit greyscale, and back. Errors are rounded to 1e-5 1/m.
///
/// @param name  of the file, for messages
/// @throws Error "scan-malformed"  if it is no such file, damaged, or cut short
std::vector<std::byte> encode_sensor_map(const SensorMap& map);
SensorMap decode_sensor_map(std::string_view name, std::span<const std::byte> png);

/// The same from a file. @throws Error "scan-malformed"  also if there is none
SensorMap read_sensor_map(const std::filesystem::path& file);

/// Writes a map whole or not at all. @throws Error "disk-full", "write-failed"
void write_sensor_map(const std::filesystem::path& file, const SensorMap& map);

/// What `wall.json` says (format "octurn-wall", version 1): frames of a sensor that looks at a
/// wall.
struct Wall {
  std::string sensor_name = {};
  std::string sensor_serial = {};  ///< empty if it tells none
  Intrinsics intrinsics = {};
  std::vector<std::string> frames = {};  ///< the depth images, relative to the folder
};

/// Reads and checks the text of a `wall.json`. @throws Error "recording-malformed"  that names the
/// key
Wall parse_wall(std::string_view text);

/// The same from `folder/wall.json`. @throws Error "recording-malformed"  also if there is no such
/// file
Wall read_wall(const std::filesystem::path& folder);

/// @throws Error "recording-malformed"  if there is no such file
/// @throws Error "snapshot-malformed"  if it is no depth image of the wall's size
DepthFrame read_wall_frame(const std::filesystem::path& folder, const Wall& wall,
                           std::size_t frame);

/// Writes `folder/wall.json`, whole or not at all. @throws Error "disk-full", "write-failed"
void write_wall(const std::filesystem::path& folder, const Wall& wall);

/// The file of the wall's frame of that index: "frames/000.png".
std::string wall_frame_file(int index);

/// The mean of the frames of one look at a wall. It takes 6 bytes a pixel, however many they are.
class WallView {
 public:
  explicit WallView(const Intrinsics& intrinsics);

  /// @throws std::invalid_argument  if the frame has another size than the intrinsics say
  void add(const DepthFrame& frame);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  int frames() const { return frames_; }

  /// Mean inverse depth of a pixel, 1/m; 0 if it has a reading in less than half of the frames.
  double inverse_depth(int u, int v) const;

 private:
  Intrinsics intrinsics_;
  int frames_ = 0;
  std::vector<float> sum_;  // 1/m
  std::vector<std::uint16_t> readings_;
};

/// What a look at a wall tells.
struct WallReport {
  double distance = 0;  ///< metres, of the wall along the optical axis
  double slant = 0;     ///< radians, between the optical axis and the wall's normal
  double coverage = 0;  ///< share of the pixels that have a reading
  double before = 0;    ///< 1/m, root mean square of the residuals of 4 x 4 pixels to a plane
  double after = 0;     ///< the same with the map
};

/// A sensor's map, as walls tell.
struct SensorMapReport {
  bool accepted = false;
  std::string reason = {};  ///< why not, for people; empty if accepted
  SensorMap map = {};       ///< if accepted; without serial and time
  std::vector<WallReport> walls = {};
};

/// Finds what a sensor reads too much at each pixel from looks at flat walls. A plane is linear in
/// u and v where depth is inverse (Khoshelham and Elberink 2012); what is left of a look is the
/// sensor's. One look makes a map for all distances, two or more one that changes with distance.
///
/// @param views  at least one, all of one sensor
/// @throws std::invalid_argument  if there is none, or their intrinsics differ
SensorMapReport fit_sensor_map(std::span<const WallView> views);

}  // namespace octurn
