#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sensor/depth_sensor.hpp"
#include "turntable/stepper.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// The devices to scan with.
struct RigOptions {
  std::string sensor_uri = {};                  ///< for OpenNI2
  double speed = 1.0;                           ///< of a simulated rig, relative to life
  std::optional<StepperSettings> stepper = {};  ///< of the real turntable; none: it is simulated
  double platform_angle_deg = 0;                ///< at the beginning
  /// Open the two devices. Tests put devices of their own in their place.
  std::function<std::unique_ptr<DepthSensor>(const std::string& uri)> open_sensor =
      octurn::open_sensor;
  std::function<Stepper::SetLine(const StepperSettings&)> open_lines = open_gpio_lines;
};

/// The sensor and the turntable under it. Used by one thread at a time.
class Rig {
 public:
  explicit Rig(RigOptions options);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Opens the sensor if it is closed. @throws Error "sensor-missing" or "sensor-failed"
  DepthSensor& sensor();

  /// Has the object of a simulated rig lie so, as `DepthSensor::lay_object` says.
  void lay_object(int pose);

  /// Closes the sensor, which switches its projector off; the next use opens it again.
  void close_sensor() { sensor_.reset(); }

  /// Since when the sensor is open, and warms up; nothing while it is closed.
  std::optional<std::chrono::steady_clock::time_point> sensor_since() const {
    return sensor_ ? std::optional(sensor_since_) : std::nullopt;
  }

  /// Opens the turntable if it is closed.
  /// @throws Error "turntable-missing" or "turntable-failed"
  Turntable& turntable();

  /// Switches the turntable's motor off.
  void release_turntable();

  /// Releases the turntable's lines, which switches the motor off. The next use opens them again
  /// with the platform's angle unchanged.
  void close_turntable();

  /// The platform's angle, degrees in [0, 360), counter-clockwise seen from above.
  double platform_angle_deg() const;

  /// The number of late pulses of the motor since the construction of this object.
  int late_pulses() const;

 private:
  RigOptions options_;
  int object_pose_ = 0;
  double closed_angle_deg_;     // the platform's, when the turntable was closed
  int closed_late_pulses_ = 0;  // of the turntables closed so far
  std::unique_ptr<Turntable> turntable_;
  std::unique_ptr<DepthSensor> sensor_;
  std::chrono::steady_clock::time_point sensor_since_ = {};
};

}  // namespace octurn
