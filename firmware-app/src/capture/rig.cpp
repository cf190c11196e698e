#include "capture/rig.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "capture/plan.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "sensor/wrapped_sensor.hpp"

namespace octurn {
namespace {

/// A simulated sensor of a platform that goes on swinging while frames are read. A hurried
/// simulation on a busy machine may have frames of before in store: they are passed over.
class SensorOfPlatform final : public WrappedSensor {
 public:
  SensorOfPlatform(std::unique_ptr<DepthSensor> sensor, SimulatedTurntable* const& turntable)
      : WrappedSensor(std::move(sensor)), turntable_(turntable) {}

  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    constexpr std::chrono::duration<double> frame_time(1 / 30.0);
    if (turntable_ != nullptr) {
      turntable_->swing(frame_time);
    }
    const auto swung = std::chrono::steady_clock::now();
    for (;;) {
      std::optional<TimedFrame> timed = WrappedSensor::read(stop);
      if (!timed || timed->time >= swung) {
        return timed;
      }
    }
  }

 private:
  SimulatedTurntable* const& turntable_;
};

}  // namespace

Rig::Rig(RigOptions options)
    : options_(std::move(options)), closed_angle_deg_(options_.platform_angle_deg) {}

Rig::~Rig() = default;

DepthSensor& Rig::sensor() {
  if (options_.laser) {
    throw Error(ErrorCode::sensor_other, "this rig has a camera with lasers, and no depth sensor",
                "Such a rig can scan and be calibrated. Recordings, maps of a sensor's error and "
                "tests of a turn need a depth sensor.");
  }
  if (!sensor_) {
    sensor_ = options_.open_sensor(options_.sensor_uri);
    if (options_.load) {
      sensor_ = std::make_unique<SensorOfPlatform>(std::move(sensor_), simulated_);
    }
    sensor_since_ = std::chrono::steady_clock::now();
    counted_ = PacketCounts();
    show_platform();
    sensor_->set_object_pose(object_pose_);
  }
  return *sensor_;
}

void Rig::use_lens(const CameraLens& lens) {
  options_.laser->lens = lens.intrinsics;
  options_.laser->k1 = lens.k1;
  options_.laser->k2 = lens.k2;
}

void Rig::use_pose(const Eigen::Isometry3d& platform_from_sensor,
                   const std::vector<Laser>& lasers) {
  options_.laser->platform_from_sensor = platform_from_sensor;
  for (LaserLine* const line : {&options_.laser->left, &options_.laser->right}) {
    const auto given = std::ranges::find(lasers, line->laser.name, &Laser::name);
    if (given != lasers.end()) {
      line->laser.normal = given->normal;
      line->laser.distance = given->distance;
    }
  }
}

Camera& Rig::camera() {
  if (!camera_) {
    CameraAndLasers opened = options_.open_camera(*options_.laser);
    lasers_.emplace(lines_of(*options_.laser).size(), std::move(opened.set_line));
    camera_ = std::move(opened.camera);
    sensor_since_ = std::chrono::steady_clock::now();
    show_platform();
    camera_->set_object_pose(object_pose_);
  }
  return *camera_;
}

Lasers& Rig::lasers() {
  camera();
  return *lasers_;
}

std::optional<double> Rig::sensor_on_for() const {
  const auto since = sensor_since();
  const bool is_recording = std::filesystem::exists(options_.sensor_uri);
  return since && !is_recording
             ? std::optional(std::floor(
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - *since)
                       .count()))
             : std::nullopt;
}

double Rig::take_lost_share() {
  const std::optional<PacketCounts> before = std::exchange(counted_, sensor().packet_counts());
  return lost_share(before, counted_);
}

void Rig::close_sensor() {
  lasers_.reset();
  camera_.reset();
  sensor_.reset();
}

void Rig::set_object_pose(int pose) {
  object_pose_ = pose;
  if (camera_) {
    camera_->set_object_pose(pose);
  }
  if (sensor_) {
    sensor_->set_object_pose(pose);
  }
}

Turntable& Rig::turntable() {
  if (turntable_) {
    return *turntable_;
  }
  if (options_.stepper) {
    const int steps = to_motion(*options_.stepper).steps_per_turn;
    turntable_ =
        std::make_unique<Stepper>(*options_.stepper, options_.open_lines(*options_.stepper),
                                  position_at(closed_angle_deg_, steps));
  } else {
    auto simulated = std::make_unique<SimulatedTurntable>(
        [this](double angle) { show(angle); }, options_.speed, options_.motion,
        position_at(closed_angle_deg_, options_.motion.steps_per_turn), options_.load);
    simulated_ = simulated.get();
    turntable_ = std::move(simulated);
  }
  turntable_->set_pace(pace_);
  return *turntable_;
}

void Rig::set_pace(double pace) {
  pace_ = pace;
  if (turntable_) {
    turntable_->set_pace(pace);
  }
}

void Rig::release_turntable() {
  set_pace(1);
  if (turntable_) {
    turntable_->release();
  }
}

void Rig::close_turntable() {
  closed_angle_deg_ = platform_angle_deg();
  closed_late_pulses_ = late_pulses();
  simulated_ = nullptr;
  turntable_.reset();
}

void Rig::show_platform() {
  show(simulated_ != nullptr ? simulated_->angle() : radians_from_degrees(platform_angle_deg()));
}

/// @param angle  of the platform, radians
void Rig::show(double angle) {
  if (sensor_) {
    sensor_->show_angle(angle);
  }
  if (camera_) {
    camera_->show_angle(angle);
  }
}

double Rig::platform_angle_deg() const {
  return turntable_ ? angle_deg_at(turntable_->position(), turntable_->steps_per_turn())
                    : closed_angle_deg_;
}

int Rig::late_pulses() const {
  return closed_late_pulses_ + (turntable_ ? turntable_->late_pulses() : 0);
}

CameraAndLasers open_camera_and_lasers(const LaserSettings& settings) {
  Lasers::SetLine lines = open_laser_lines(to_gpio_names(settings));
  const CameraSettings camera_settings{.width = settings.lens.width,
                                       .height = settings.lens.height,
                                       .exposure = settings.exposure,
                                       .gain = settings.gain,
                                       .focus = settings.platform_from_sensor.translation().norm()};
  return {.camera = open_camera(camera_settings), .set_line = std::move(lines)};
}

}  // namespace octurn
