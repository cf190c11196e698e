#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "commands/commands.hpp"
#include "rig/kinect_device.hpp"
#include "sensor/depth_sensor.hpp"
#include "sensor/packet_logger.hpp"

namespace octurn {

/// Records what comes from a Kinect over USB, while somebody reads its frames.
class UsbRecording {
 public:
  /// Begins. @param sensor  outlives this object
  /// @throws Error "sensor-other"  if the sensor is no Kinect
  /// @throws Error "write-failed"  if the file could not be written later
  UsbRecording(DepthSensor& sensor, const RecordArguments& arguments);

  /// Writes the file, and one line to standard output that sums it up.
  void write();

 private:
  DepthSensor& sensor_;
  PacketLogger* logger_;  // the same sensor
  std::filesystem::path file_;
  std::optional<PacketCounts> before_;
};

/// Records what comes from a Kinect over USB, in the form of `octurn record --usb`.
/// @return nothing if the sensor is no Kinect, or `stop` is requested first
/// @throws Error  as `DepthSensor::read`, except that a silent sensor is recorded, too
std::optional<std::string> usb_log_text(DepthSensor& sensor, std::chrono::seconds duration,
                                        const std::stop_token& stop);

}  // namespace octurn
