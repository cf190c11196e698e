#include "scan/rig.hpp"

#include <utility>

#include "octurn/units.hpp"
#include "scan/plan.hpp"
#include "turntable/simulated_turntable.hpp"

namespace octurn {

bool is_simulated_sensor(const std::string& uri) { return uri.starts_with("octurn-simulator:"); }

Rig::Rig(RigOptions options)
    : options_(std::move(options)),
      turntable_(std::make_unique<SimulatedTurntable>(
          [this](double angle) {
            if (sensor_) {
              sensor_->show_angle(angle);
            }
          },
          options_.speed)) {}

Rig::~Rig() = default;

DepthSensor& Rig::sensor() {
  if (!sensor_) {
    sensor_ = std::make_unique<DepthSensor>(options_.sensor_uri);
    sensor_->show_angle(
        radians_from_degrees(angle_deg_at(turntable_->position(), turntable_->steps_per_turn())));
  }
  return *sensor_;
}

}  // namespace octurn
