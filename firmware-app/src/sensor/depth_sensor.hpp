#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"
#include "rig/kinect_device.hpp"

namespace octurn {

/// A depth frame, and the end of its exposure by the steady clock.
struct TimedFrame {
  DepthFrame frame = {};
  std::chrono::steady_clock::time_point time = {};
  std::vector<std::size_t> lost = {};  ///< pixels that were lost on the way; they have no reading
};

/// A depth camera: a Kinect v1, a simulated one, any sensor that OpenNI2 supports, or a recording
/// in place of one. Used by one thread at a time.
class DepthSensor {
 public:
  DepthSensor() = default;
  virtual ~DepthSensor() = default;
  DepthSensor(const DepthSensor&) = delete;
  DepthSensor& operator=(const DepthSensor&) = delete;

  virtual const std::string& name() const = 0;
  virtual const Intrinsics& intrinsics() const = 0;

  /// Identifies this sensor among others of its kind: its serial number, else its USB port; empty
  /// if neither is known.
  virtual std::string serial() const = 0;

  /// Waits for the next frame.
  /// @return nothing if a stop was requested first
  /// @throws Error "sensor-silent" if no frame comes for 2 s by the sensor's clock, "sensor-lost"
  ///               if the device is gone
  virtual std::optional<TimedFrame> read(const std::stop_token& stop) = 0;

  /// Whether the sensor shows infrared pictures of the size of its depth frames.
  virtual bool has_infrared() const { return false; }

  /// Waits for the next infrared picture. The first one stops the depth stream, and the next depth
  /// frame the infrared one.
  /// @return nothing if a stop was requested first
  /// @throws Error "sensor-other" if the sensor shows none; and as `read`
  virtual std::optional<Picture> read_infrared(const std::stop_token& stop);

  /// The attitude from the accelerometer; nothing if the sensor has none that can be read. A
  /// Kinect is asked for it over USB, which takes up to 500 ms: not while frames are taken.
  virtual std::optional<Tilt> tilt() const = 0;

  /// What has arrived of its packets since it was opened; nothing if it does not count them.
  virtual std::optional<PacketCounts> packet_counts() const = 0;

  /// Sets the platform's angle in a simulated sensor or a recording. A recording restarts with its
  /// first frame of that angle. Other sensors ignore it.
  /// @param angle  radians, counter-clockwise seen from above
  virtual void show_angle(double angle) = 0;

  /// Turns a simulated sensor to a wall, and back again. Other sensors ignore it: a person turns
  /// them.
  /// @param distance  metres; nothing: back to the platform
  virtual void show_wall(std::optional<double> distance);

  /// Shows a printed board to a simulated sensor. Other sensors ignore it: a person does it.
  /// @param hold  number of the place and tilt in which it is held, from 1; 0: it is put away
  virtual void show_board(int hold);

  /// Turns the object of a simulated sensor over. Other sensors ignore it: a person does it.
  /// @param pose  number of the pose; 0 is the initial one
  virtual void set_object_pose(int pose);
};

/// Opens a sensor and starts its depth stream.
/// @param uri  of an OpenNI2 device, the name of an .oni file, or the folder of a recording; empty:
///             the first device found
/// @throws Error "sensor-missing" if there is none, "sensor-failed" if it does not start,
///               "recording-malformed"
std::unique_ptr<DepthSensor> open_sensor(const std::string& uri);

/// The same for a device of OpenNI2.
std::unique_ptr<DepthSensor> open_openni_sensor(const std::string& uri);

/// The same for a recording of OpenNI2's recorder. @param path  of the .oni file
std::unique_ptr<DepthSensor> open_oni_file(const std::string& path);

/// The same for a recording of `octurn record`. @param folder  of the recording
std::unique_ptr<DepthSensor> open_recording(const std::string& folder);

/// Whether a URI names a simulated sensor.
bool is_simulated_sensor(const std::string& uri);

/// Loads OpenNI2 and its drivers on the first call. The process's working directory changes
/// meanwhile, so a program with several threads calls it before it starts the second.
/// @throws Error "sensor-failed"
void load_sensor_drivers();

std::string openni_version();

}  // namespace octurn
