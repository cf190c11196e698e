#include "doctor/sensor_reading.hpp"

#include <utility>

#include "capture/take_pictures.hpp"

namespace octurn {
namespace {

constexpr int first_frames = 10;  // skipped: a sensor that was just opened is still irregular
constexpr int timed_frames = 60;  // two seconds
constexpr std::size_t kept_frames = 10;  // as a scan takes at each stop

/// @return nothing if `stop` is requested first
std::optional<SensorSample> sample(DepthSensor& sensor, const std::stop_token& stop) {
  SensorSample sample{
      .name = sensor.name(), .serial = sensor.serial(), .intrinsics = sensor.intrinsics()};
  std::optional<PacketCounts> before;
  for (int count = 0; count < first_frames + timed_frames; ++count) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return std::nullopt;
    }
    if (count < first_frames) {
      before = sensor.packet_counts();
      continue;
    }
    sample.times.push_back(timed->time);
    if (first_frames + timed_frames - count <= static_cast<int>(kept_frames)) {
      sample.frames.push_back(std::move(timed->frame));
    }
  }
  if (const auto after = sensor.packet_counts(); after && before) {
    sample.packets = *after - *before;
  }
  sample.tilt = sensor.tilt();
  return sample;
}

/// @return nothing if `stop` is requested first
/// @throws Error  with the fault of the camera, the room's light or a laser
std::optional<CameraSample> sample_camera(Rig& rig, const std::stop_token& stop) {
  const auto taken = take_pictures_here(rig, stop, {});
  if (!taken) {
    return std::nullopt;
  }
  CameraSample sample{.name = rig.camera().name(),
                      .width = taken->pictures.front().width,
                      .height = taken->pictures.front().height};
  for (const Laser& laser : laser_camera(*rig.laser()).lasers) {
    sample.lasers.push_back(laser.name);
  }
  return sample;
}

}  // namespace

SensorReading read_sensor(Rig& rig, const std::stop_token& stop) {
  try {
    if (rig.laser() != nullptr) {
      if (auto seen = sample_camera(rig, stop)) {
        return *std::move(seen);
      }
    } else if (auto seen = sample(rig.sensor(), stop)) {
      return *std::move(seen);
    }
    return Failure{.code = ErrorCode::busy,
                   .detail = "not checked: something else began to use the sensor",
                   .hint = "Check again later."};
  } catch (const Error& error) {
    rig.close_sensor();
    return to_failure(error);
  }
}

}  // namespace octurn
