#include "sensor/simulated_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sensor/wrapped_sensor.hpp"

namespace octurn {
namespace {

class SensorOnMechanism final : public WrappedSensor {
 public:
  SensorOnMechanism(std::unique_ptr<DepthSensor> sensor, const SimulatedMechanism& mechanism)
      : WrappedSensor(std::move(sensor)), mechanism_(mechanism) {}

  void show_angle(double angle) override {
    // `angle` may be wrapped. Successive angles differ by less than half a turn.
    motor_ += mechanism_.rate * std::remainder(angle - told_, 2 * std::numbers::pi);
    told_ = angle;
    // Backlash: a motor that keeps its direction moves the platform at once, a reversed one only
    // after the play.
    const double behind = mechanism_.rate < 0 ? -mechanism_.play : 0;
    platform_ = std::clamp(platform_, motor_ + behind, motor_ + behind + mechanism_.play);
    WrappedSensor::show_angle(platform_);
  }

 private:
  SimulatedMechanism mechanism_;
  double told_ = 0;  // radians, like the next two
  double motor_ = 0;
  double platform_ = 0;
};

}  // namespace

std::unique_ptr<DepthSensor> on_mechanism(std::unique_ptr<DepthSensor> sensor,
                                          const SimulatedMechanism& mechanism) {
  return std::make_unique<SensorOnMechanism>(std::move(sensor), mechanism);
}

}  // namespace octurn
