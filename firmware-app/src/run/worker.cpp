#include "run/worker.hpp"

#include <utility>

#include "log.hpp"
#include "run/rebuild.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr auto retry_interval = 2s;     // between attempts to read a failed sensor
constexpr auto open_without_use = 30s;  // then the sensor is closed: its light and traffic end
constexpr auto idle_beat = 5s;          // between heartbeats while there is nothing to do

}  // namespace

Worker::Worker(const RigOptions& rig, const Limits& limits, const WorkerPorts& ports)
    : rig_(rig),
      speed_(rig.speed),
      retries_(rig.retries),
      told_laser_(rig.laser),
      limits_(limits),
      ports_(ports) {}

void Worker::work() {
  open_turntable();  // so that the status shows it
  Clock::time_point last_use = Clock::now();
  for (;;) {
    ports_.heartbeat.beat();
    std::optional<CommandSlot::Taken> taken = ports_.slot.take(idle_beat);
    if (taken) {
      carry_out(*taken);
      last_use = Clock::now();
    } else if (ports_.slot.has_ended()) {
      return;
    } else if (Clock::now() - last_use >= open_without_use) {
      rig_.close_sensor();
      ports_.board.set_sensor_closed();
    }
  }
}

/// Executes a command, and catches its exceptions, so that the worker outlives them.
void Worker::carry_out(CommandSlot::Taken& taken) {
  try {
    std::visit([&](auto& command) { carry_out(command, taken.stop); }, taken.command);
  } catch (...) {
    log::error("scanner", current_failure().detail);
  }
  ports_.slot.finish();
}

void Worker::carry_out(CameraCommand& /*command*/, const std::stop_source& stop) {
  if (!ports_.devices.get()->turntable_is_ready) {
    open_turntable();  // its GPIO lines may be free now
  }
  try {
    show_next_frame(stop.get_token());
  } catch (...) {
    const Failure failure = current_failure();
    rig_.close_sensor();
    ports_.board.set_sensor_closed();
    set_sensor_failed(failure);
    ports_.slot.wait_for_command(retry_interval);
  }
}

/// Shows the sensor's next frame, or the camera's next picture with all lasers off.
void Worker::show_next_frame(const std::stop_token& stop) {
  if (rig_.laser() != nullptr) {
    if (std::optional<TimedPicture> timed = rig_.camera().read(stop)) {
      show_picture(std::move(timed->picture));
    }
  } else if (std::optional<TimedFrame> timed = rig_.sensor().read(stop)) {
    show_frame(std::move(timed->frame));
  }
}

void Worker::show_frame(DepthFrame frame) {
  DepthSensor& sensor = rig_.sensor();
  ports_.heartbeat.beat();
  set_sensor_ready(sensor.name());
  introduce_sensor();
  ports_.board.set_camera_frame(std::move(frame), sensor.intrinsics());
}

void Worker::show_picture(Picture picture) {
  ports_.heartbeat.beat();
  set_sensor_ready(rig_.camera().name());
  introduce_sensor();
  ports_.board.set_camera_picture(std::move(picture));
}

void Worker::carry_out(DeviceCheckCommand& command, const std::stop_source& stop) {
  ports_.heartbeat.suspend();  // a slow turntable takes minutes for a turn
  command.check(rig_, stop.get_token());
}

void Worker::carry_out(RebuildCommand& command, const std::stop_source& /*stop*/) {
  ports_.heartbeat.suspend();
  rebuild(command);
}

void Worker::carry_out(ScanCommand& command, const std::stop_source& stop) {
  run(std::move(command.job), stop.get_token());
}

void Worker::carry_out(ResumeCommand& command, const std::stop_source& stop) {
  run(std::move(command.job), stop.get_token());
}

void Worker::open_turntable() {
  try {
    rig_.turntable();
    set_turntable_ready();
  } catch (...) {
    set_turntable_failed(current_failure());
  }
}

// A state is set before it is shown: clients act on what they see.

void Worker::set_sensor_ready(const std::string& name) {
  ports_.devices.update([](DeviceStates& devices) { devices.sensor_is_ready = true; });
  ports_.board.set_sensor_ready(name);
}

void Worker::set_sensor_failed(const Failure& failure) {
  ports_.devices.update([](DeviceStates& devices) { devices.sensor_is_ready = false; });
  ports_.board.set_sensor_failed(failure);
}

void Worker::set_turntable_ready() {
  ports_.devices.update([](DeviceStates& devices) {
    devices.turntable_is_ready = true;
    devices.turntable_failure.reset();
  });
  ports_.board.set_turntable_ready();
}

void Worker::set_turntable_failed(const Failure& failure) {
  ports_.devices.update([&](DeviceStates& devices) {
    devices.turntable_is_ready = false;
    devices.turntable_failure = failure;
  });
  ports_.board.set_turntable_failed(failure);
}

}  // namespace octurn
