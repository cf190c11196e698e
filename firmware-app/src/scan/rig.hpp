#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sensor/depth_sensor.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// What to scan with.
struct RigOptions {
  std::string sensor_uri = {};                  ///< for OpenNI2
  double speed = 1.0;                           ///< of the simulated turntable, relative to life
  std::optional<StepperSettings> stepper = {};  ///< of the real turntable; none: it is simulated
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

 private:
  RigOptions options_;
  std::unique_ptr<GpioLines> lines_;
  std::unique_ptr<Turntable> turntable_;  // drives lines_: ends before them
  std::unique_ptr<DepthSensor> sensor_;
};

}  // namespace octurn
