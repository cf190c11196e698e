#pragma once

#include <memory>
#include <string>
#include <utility>

#include "sensor/wrapped_sensor.hpp"

namespace octurn {

/// A simulated sensor that falls silent as soon as the platform turns: after the first stop of a
/// scan, and not before it.
class SensorSilentOnceTurned final : public WrappedSensor {
 public:
  explicit SensorSilentOnceTurned(std::string uri)
      : WrappedSensor(open_sensor(uri)), uri_(std::move(uri)) {}

  void show_angle(double angle) override {
    if (angle != 0 && !std::exchange(is_turned_, true)) {
      sensor() = nullptr;
      sensor() = open_sensor(uri_ + "&silent-after=0");
    }
    WrappedSensor::show_angle(angle);
  }

 private:
  std::string uri_;
  bool is_turned_ = false;
};

}  // namespace octurn
