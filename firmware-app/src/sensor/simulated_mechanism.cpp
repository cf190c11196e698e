#include "sensor/simulated_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace octurn {
namespace {

class SensorOnMechanism final : public DepthSensor {
 public:
  SensorOnMechanism(std::unique_ptr<DepthSensor> sensor, const SimulatedMechanism& mechanism)
      : sensor_(std::move(sensor)), mechanism_(mechanism) {}

  const std::string& name() const override { return sensor_->name(); }
  const Intrinsics& intrinsics() const override { return sensor_->intrinsics(); }
  std::string serial() const override { return sensor_->serial(); }
  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    return sensor_->read(stop);
  }
  std::optional<Tilt> tilt() const override { return sensor_->tilt(); }
  std::optional<PacketCounts> packet_counts() const override { return sensor_->packet_counts(); }

  void show_wall(std::optional<double> distance) override { sensor_->show_wall(distance); }
  void set_object_pose(int pose) override { sensor_->set_object_pose(pose); }

  void show_angle(double angle) override {
    // `angle` may be wrapped. Successive angles differ by less than half a turn.
    motor_ += mechanism_.rate * std::remainder(angle - told_, 2 * std::numbers::pi);
    told_ = angle;
    // Backlash: a motor that keeps its direction moves the platform at once, a reversed one only
    // after the play.
    const double behind = mechanism_.rate < 0 ? -mechanism_.play : 0;
    platform_ = std::clamp(platform_, motor_ + behind, motor_ + behind + mechanism_.play);
    sensor_->show_angle(platform_);
  }

 private:
  std::unique_ptr<DepthSensor> sensor_;
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
