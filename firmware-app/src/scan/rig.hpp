#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sensor/depth_sensor.hpp"
#include "turntable/stepper.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

std::unique_ptr<DepthSensor> open_sensor(const std::string& uri);

/// The lines of the GPIO header that those settings name, held as long as what sets them lives.
/// @throws Error "turntable-missing" or "turntable-failed"
Stepper::SetLine open_gpio_lines(const StepperSettings& settings);

/// What to scan with.
struct RigOptions {
  std::string sensor_uri = {};                  ///< for OpenNI2
  double speed = 1.0;                           ///< of a simulated rig, relative to life
  std::optional<StepperSettings> stepper = {};  ///< of the real turntable; none: it is simulated
  double platform_angle_deg = 0;                ///< where the platform stands
  /// How the two are opened. Tests have devices of their own.
  std::function<std::unique_ptr<DepthSensor>(const std::string& uri)> open_sensor =
      octurn::open_sensor;
  std::function<Stepper::SetLine(const StepperSettings&)> open_lines = open_gpio_lines;
};

bool is_simulated_sensor(const std::string& uri);

/// The sensor and the turntable under it. Used by one thread at a time.
class Rig {
 public:
  explicit Rig(RigOptions options);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Opens the sensor if it is closed. @throws Error "sensor-missing" or "sensor-failed"
  DepthSensor& sensor();

  /// Closes the sensor, which ends its light and its traffic; the next use opens it again.
  void close_sensor() { sensor_.reset(); }

  /// Takes hold of the turntable's lines if it has not yet.
  /// @throws Error "turntable-missing" or "turntable-failed"
  Turntable& turntable();

  /// Lets go of the platform, if it is held.
  void release_turntable();

  /// Lets go of the turntable's lines, with which the motor is off. The next use takes hold of them
  /// again, and knows where the platform stands.
  void close_turntable();

  /// Where the platform stands, degrees in [0, 360), counter-clockwise seen from above.
  double platform_angle_deg() const;

  /// The motor's pulses that came late since this is.
  int late_pulses() const;

 private:
  RigOptions options_;
  double closed_angle_deg_;     // where the platform stood when the turntable was closed
  int closed_late_pulses_ = 0;  // of turntables that were closed
  std::unique_ptr<Turntable> turntable_;
  std::unique_ptr<DepthSensor> sensor_;
};

}  // namespace octurn
