#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"
#include "rig/kinect_device.hpp"
#include "sensor/new_folder.hpp"

namespace octurn {

/// Metadata of a recorded frame.
struct RecordedFrame {
  std::chrono::duration<double> time = {};  ///< of its exposure, since the first frame's
  double angle = 0;                         ///< of the platform, radians
  std::optional<Tilt> tilt = {};
};

/// A sensor's recorded frames: a folder with `recording.json` and, for each frame in order, its
/// depth as a PNG like those of a scan folder (`frames/000000.png`).
///
/// `{"format": "octurn-recording", "version": 1, "sensor": {"name": "Kinect v1", "width": 640,
/// "height": 480, "fx": 575.8, "fy": 575.8, "cx": 320, "cy": 240, "depth_unit_m": 0.0001},
/// "frames": [{"time_s": 0, "angle_deg": 0, "pitch_deg": -25, "roll_deg": 0}, ...]}`. "pitch_deg"
/// and "roll_deg" are left out if the sensor measures no tilt. "sensor" also has "serial" if that
/// is known.
struct Recording {
  std::string sensor_name = {};
  std::string sensor_serial = {};  ///< empty if unknown
  Intrinsics intrinsics = {};
  std::vector<RecordedFrame> frames = {};
};

/// Reads the text of a `recording.json`.
/// @throws Error "recording-malformed"  that names the key and what is wrong with it
Recording parse_recording(std::string_view text);

/// The same from the folder. @throws Error  also if there is no such file
Recording read_recording(const std::filesystem::path& folder);

/// The depth of one frame. @throws Error  if its file is missing, damaged, or of another size
DepthFrame read_recorded_frame(const std::filesystem::path& folder, const Recording& recording,
                               std::size_t frame);

/// Writes a recording that appears whole or not at all: under a temporary name beside `folder`
/// until it is committed.
class RecordingWriter {
 public:
  /// @throws Error "write-failed"  if `folder` exists or cannot be made
  RecordingWriter(const std::filesystem::path& folder, std::string sensor_name,
                  std::string sensor_serial, const Intrinsics& intrinsics);

  /// Appends a frame. @throws Error "write-failed"
  void write(const DepthFrame& frame, const RecordedFrame& about);

  /// Renames the folder to its own name; returns once it is on disk. @throws Error "write-failed"
  void commit();

 private:
  NewFolder folder_;
  Recording recording_;
};

}  // namespace octurn
