#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "octurn/depth_frame.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {

/// What a DepthSensor reads from; its functions are those of DepthSensor.
class SensorDevice {
 public:
  SensorDevice() = default;
  virtual ~SensorDevice() = default;
  SensorDevice(const SensorDevice&) = delete;
  SensorDevice& operator=(const SensorDevice&) = delete;

  virtual const std::string& name() const = 0;
  virtual const Intrinsics& intrinsics() const = 0;
  virtual std::optional<TimedFrame> read(const std::stop_token& stop) = 0;
  virtual std::optional<Tilt> tilt() const = 0;
  virtual std::optional<int> damaged_frames() const = 0;
  virtual void show_angle(double angle) = 0;
};

/// Opens what OpenNI2 knows by that URI, or by that name of an .oni file.
std::unique_ptr<SensorDevice> open_openni_device(const std::string& uri);

/// Opens a recording of `octurn record`. @param folder  that holds it
std::unique_ptr<SensorDevice> open_recording(const std::string& folder);

}  // namespace octurn
