#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "octurn/depth_frame.hpp"
#include "sensor/tilt.hpp"

namespace octurn {

/// A depth frame and when its exposure ended, by the steady clock.
struct TimedFrame {
  DepthFrame frame = {};
  std::chrono::steady_clock::time_point time = {};
};

/// Loads OpenNI2 and its drivers, the first time it is called. The working directory of the process
/// changes meanwhile, so a program with several threads calls it before it starts the second.
/// @throws Error "sensor-failed"
void load_sensor_drivers();

std::string openni_version();

class SensorDevice;

/// A depth camera: a Kinect v1, a simulated one, any sensor that OpenNI2 knows, or a recording that
/// takes its place. Used by one thread at a time.
class DepthSensor {
 public:
  /// Opens the OpenNI2 device of that URI, the .oni file of that name, or the recording in that
  /// folder; the first device found if `uri` is empty. Starts its depth stream.
  /// @throws Error "sensor-missing" if there is none, "sensor-failed" if it does not start,
  ///               "recording-malformed"
  explicit DepthSensor(const std::string& uri);
  explicit DepthSensor(std::unique_ptr<SensorDevice> device);
  ~DepthSensor();
  DepthSensor(const DepthSensor&) = delete;
  DepthSensor& operator=(const DepthSensor&) = delete;

  const std::string& name() const;
  const Intrinsics& intrinsics() const;

  /// Waits for the next frame; nothing if stopped before it came.
  /// @throws Error "sensor-silent" if none comes for 2 s, "sensor-lost" if the device is gone
  std::optional<TimedFrame> read(const std::stop_token& stop);

  /// How it stands, by its accelerometer; nothing if it has none that can be read.
  std::optional<Tilt> tilt() const;

  /// How many frames came damaged since it was opened, and were dropped; nothing if it does not
  /// count them.
  std::optional<int> damaged_frames() const;

  /// Tells a simulated sensor or a recording where the turntable stands, and that what it sees from
  /// now on begins there. Others pass it over.
  /// @param angle  of the platform, radians, counter-clockwise seen from above
  void show_angle(double angle);

 private:
  std::unique_ptr<SensorDevice> device_;
};

}  // namespace octurn
