#include <chrono>

#include "capture/plan.hpp"
#include "commands/commands.hpp"
#include "commands/usb_recording.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "sensor/recording.hpp"
#include "signal_stop.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int usual_stop_frames = 10;

/// The next frame whose exposure ended after the platform had settled.
TimedFrame settled_frame(DepthSensor& sensor, Clock::time_point settled,
                         const std::stop_token& stop) {
  for (;;) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      throw_stopped("no recording was written");
    }
    if (timed->time > settled) {
      return *std::move(timed);
    }
  }
}

}  // namespace

void record(const RecordArguments& arguments) {
  if (!arguments.wall.empty()) {
    record_wall(arguments);
    return;
  }
  if (arguments.output.empty()) {
    record_usb(arguments);
    return;
  }
  const Config config = make_config(arguments.config);
  const RigOptions options = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  const std::stop_token stop = signal.token();
  Rig rig(options);
  DepthSensor& sensor = rig.sensor();
  Turntable& turntable = rig.turntable();
  const int steps = turntable.steps_per_turn();
  RecordingWriter writer(arguments.output, sensor.name(), sensor.serial(), sensor.intrinsics());
  const int frames = arguments.frames.value_or(usual_stop_frames);
  ProgressBar bar;
  std::optional<Clock::time_point> begin;
  int done = 0;
  std::optional<UsbRecording> usb;
  if (!arguments.usb.empty()) {
    usb.emplace(sensor, arguments);
  }
  for (const std::int64_t position :
       stop_positions(turntable.position(), steps, arguments.snapshots)) {
    bar.show(done++, arguments.snapshots, "recording");
    if (!turntable.move_to(position, stop)) {
      throw_stopped("no recording was written");
    }
    const std::optional<Tilt> tilt = sensor.tilt();
    const Clock::time_point settled = Clock::now();
    for (int frame = 0; frame < frames; ++frame) {
      const TimedFrame timed = settled_frame(sensor, settled, stop);
      begin = begin.value_or(timed.time);
      writer.write(timed.frame, {.time = timed.time - *begin,
                                 .angle = radians_from_degrees(angle_deg_at(position, steps)),
                                 .tilt = tilt});
    }
  }
  writer.commit();
  if (usb) {
    usb->write();
  }
}

}  // namespace octurn
