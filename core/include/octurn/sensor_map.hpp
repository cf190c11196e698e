#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// The systematic error of a depth sensor at each pixel, measured less true, in inverse depth: a
/// fixed pattern of its lenses and its projector, which averaging of frames does not remove. It
/// changes a little with distance: at inverse depth q the error is interpolated linearly between
/// `near` and `far`.
///
/// docs/sensor-map.md describes the file, and how a map is made.
struct SensorMap {
  int width = 0;                  ///< pixels, of the sensor's frames
  int height = 0;                 ///< pixels
  double near_inverse_depth = 0;  ///< 1/m, of `near`
  double far_inverse_depth = 0;   ///< 1/m, of `far`; less than the other
  std::vector<float> near = {};   ///< 1/m, width x height, row by row from the top left
  std::vector<float> far = {};    ///< the same; empty if the error is the same at every distance
  std::string serial = {};        ///< of the sensor; empty if unknown
  std::string made = {};          ///< UTC, ISO 8601; empty if unknown
  double before = 0;  ///< 1/m: rms distance of the walls from planes, over blocks of 4 x 4 pixels
  double after = 0;   ///< the same with this map
  /// With which the walls were planes; nothing: those that the sensor reports. Distortion that
  /// these optics take out is not in the map.
  std::optional<SensorOptics> optics = {};
  /// Seconds that the sensor had been on, at that view of a wall where it was the shortest; nothing
  /// if no view knows it.
  std::optional<double> on_for = {};
};

/// A step of a Kinect v1's disparity in inverse depth, 1/m (z = 345.489 m / disparity): the usual
/// unit of its errors.
inline constexpr double disparity_unit = 1 / 345.489;

/// Subtracts the sensor's systematic error. 0 (no reading) stays 0; depths are rounded to the depth
/// unit.
///
/// @param depth_unit  metres
/// @throws std::invalid_argument  if the map is of another size
DepthFrame corrected(DepthFrame frame, const SensorMap& map, double depth_unit);

/// Encodes a map as 16-bit greyscale PNG. Errors are rounded to 1e-5 1/m.
std::vector<std::byte> encode_sensor_map(const SensorMap& map);

/// @param name  of the file, for messages
/// @throws Error "scan-malformed"  if it is another kind of file, damaged, or cut short
SensorMap decode_sensor_map(std::string_view name, std::span<const std::byte> png);

/// @throws Error "scan-malformed"  as `decode_sensor_map`, or if there is no such file
SensorMap read_sensor_map(const std::filesystem::path& file);

/// Reads the map of a sensor. A picture of another size is refused before it is decoded.
/// @throws Error "scan-malformed"  also if the map has another size than the sensor's frames
SensorMap read_sensor_map(const std::filesystem::path& file, const Intrinsics& sensor);

/// Writes a map whole or not at all. @throws Error "disk-full", "write-failed"
void write_sensor_map(const std::filesystem::path& file, const SensorMap& map);

/// The content of `wall.json` (format "octurn-wall", version 1): depth frames of a flat wall.
struct Wall {
  std::string sensor_name = {};
  std::string sensor_serial = {};  ///< empty if unknown
  Intrinsics intrinsics = {};
  std::optional<double> sensor_on_for = {};  ///< seconds that the sensor had been on, if known
  std::vector<std::string> frames = {};      ///< the depth images, relative to the folder
};

/// Parses and checks the text of a `wall.json`.
/// @throws Error "recording-malformed"  with the key
Wall parse_wall(std::string_view text);

/// Reads `folder/wall.json`.
/// @throws Error "recording-malformed"  also if there is no such file
Wall read_wall(const std::filesystem::path& folder);

/// @param frame  index in `Wall::frames`
/// @throws Error "recording-malformed"  if there is no such file
/// @throws Error "snapshot-malformed"   if it is not a depth image of the sensor's size
DepthFrame read_wall_frame(const std::filesystem::path& folder, const Wall& wall,
                           std::size_t frame);

/// Writes `folder/wall.json`, whole or not at all. @throws Error "disk-full", "write-failed"
void write_wall(const std::filesystem::path& folder, const Wall& wall);

/// The file of the frame with that index, such as "frames/000.png".
std::string wall_frame_file(int index);

/// The mean of depth frames of one wall, taken from one place. Takes 6 bytes a pixel for any number
/// of frames.
class WallView {
 public:
  /// @param on_for  seconds that the sensor had been on, if known
  explicit WallView(const Intrinsics& intrinsics, std::optional<double> on_for = {});

  /// @throws std::invalid_argument  if the frame has another size than the intrinsics say
  void add(const DepthFrame& frame);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  int frames() const { return frames_; }
  std::optional<double> on_for() const { return on_for_; }

  /// Mean inverse depth of a pixel, 1/m; 0 if it has a reading in less than half of the frames.
  double inverse_depth(int u, int v) const;

 private:
  Intrinsics intrinsics_;
  std::optional<double> on_for_;
  int frames_ = 0;
  std::vector<float> sum_;  // 1/m
  std::vector<std::uint16_t> readings_;
};

/// Measurements on one view of a wall.
struct WallReport {
  double distance = 0;  ///< metres, of the wall along the optical axis
  double slant = 0;     ///< radians, between the optical axis and the wall's normal
  double coverage = 0;  ///< share of the pixels that have a reading
  double before = 0;    ///< 1/m: rms distance from a plane, over blocks of 4 x 4 pixels
  double after = 0;     ///< the same with the map
};

/// A sensor's map, as fitted to views of walls.
struct SensorMapReport {
  bool accepted = false;
  std::string reason = {};  ///< why it was refused, for people; empty if accepted
  SensorMap map = {};       ///< if accepted; without serial and time
  std::vector<WallReport> walls = {};
};

/// Fits a sensor's map to views of flat walls. The inverse depth of a plane is linear in u and v
/// (Khoshelham and Elberink 2012); the residuals of that fit are the sensor's error. One view gives
/// a map for all distances, two or more one that changes with distance.
///
/// @param views   at least one, all of one sensor
/// @param optics  of that sensor, if they are known: a plane is one on undistorted coordinates
/// @throws std::invalid_argument  if there is none, or their intrinsics differ
SensorMapReport fit_sensor_map(std::span<const WallView> views,
                               const std::optional<SensorOptics>& optics = {});

}  // namespace octurn
