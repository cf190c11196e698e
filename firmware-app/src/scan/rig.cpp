#include "scan/rig.hpp"

#include <utility>

#include "octurn/units.hpp"
#include "scan/plan.hpp"
#include "turntable/gpio_lines.hpp"
#include "turntable/simulated_turntable.hpp"
#include "turntable/stepper.hpp"

namespace octurn {

bool is_simulated_sensor(const std::string& uri) { return uri.starts_with("octurn-simulator:"); }

Rig::Rig(RigOptions options) : options_(std::move(options)) {}

Rig::~Rig() = default;

DepthSensor& Rig::sensor() {
  if (!sensor_) {
    sensor_ = std::make_unique<DepthSensor>(options_.sensor_uri);
    if (turntable_) {
      sensor_->show_angle(
          radians_from_degrees(angle_deg_at(turntable_->position(), turntable_->steps_per_turn())));
    }
  }
  return *sensor_;
}

Turntable& Rig::turntable() {
  if (turntable_) {
    return *turntable_;
  }
  if (options_.stepper) {
    lines_ = std::make_unique<GpioLines>(lines_of(*options_.stepper));
    turntable_ = std::make_unique<Stepper>(*options_.stepper,
                                           [lines = lines_.get()](Stepper::Line line, bool high) {
                                             lines->set(static_cast<std::size_t>(line), high);
                                           });
  } else {
    const auto show = [this](double angle) {
      if (sensor_) {
        sensor_->show_angle(angle);
      }
    };
    turntable_ = std::make_unique<SimulatedTurntable>(show, options_.speed);
  }
  return *turntable_;
}

void Rig::release_turntable() {
  if (turntable_) {
    turntable_->release();
  }
}

}  // namespace octurn
