#include "commands/record.hpp"

#include <sys/utsname.h>

#include <filesystem>
#include <iomanip>
#include <iostream>
#include <vector>

#include "capture/plan.hpp"
#include "commands/commands.hpp"
#include "doctor/machine_checks.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/png.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "rig/kinect_device.hpp"
#include "rig/usb_log.hpp"
#include "sensor/new_folder.hpp"
#include "sensor/packet_logger.hpp"
#include "sensor/recording.hpp"
#include "signal_stop.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

/// Records what comes from a Kinect over USB, while somebody reads its frames.
class UsbRecording {
 public:
  /// Begins. @param sensor  outlives this object
  /// @throws Error "sensor-other"  if the sensor is no Kinect
  /// @throws Error "write-failed"  if the file could not be written later
  UsbRecording(DepthSensor& sensor, const RecordArguments& arguments);

  /// Writes the file, and one line to standard output that sums it up.
  void write();

 private:
  DepthSensor& sensor_;
  PacketLogger* logger_;  // the same sensor
  std::filesystem::path file_;
  std::optional<PacketCounts> before_;
};

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

constexpr int usual_wall_frames = 25;  // more frames do not lower the noise of the map

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

void record_wall(const RecordArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions options = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  Rig rig(options);
  DepthSensor& sensor = rig.sensor();
  NewFolder folder(arguments.wall);
  Wall wall{.sensor_name = sensor.name(),
            .sensor_serial = sensor.serial(),
            .intrinsics = sensor.intrinsics(),
            .sensor_on_for = rig.sensor_on_for(),
            .frames = {}};
  const int frames = arguments.frames.value_or(usual_wall_frames);
  ProgressBar bar;
  for (int frame = 0; frame < frames; ++frame) {
    bar.show(frame, frames, "recording");
    const std::optional<TimedFrame> timed = sensor.read(signal.token());
    if (!timed) {
      throw_stopped("no wall was written");
    }
    wall.frames.push_back(wall_frame_file(frame));
    write_depth_png(folder.path() / wall.frames.back(), timed->frame);
  }
  write_wall(folder.path(), wall);
  folder.commit();
}

namespace {

using Clock = std::chrono::steady_clock;

/// What its reader has to know of the machine; nothing that identifies it.
std::vector<std::string> notes_on_machine(const DepthSensor& sensor) {
  utsname system = {};
  ::uname(&system);
  std::vector<std::string> notes{"Octurn " + std::string(version()), sensor.name(),
                                 std::string("Linux ") + system.release + " " + system.machine};
  if (auto board = first_line("/proc/device-tree/model")) {
    notes.push_back(board->substr(0, board->find('\0')));
  }
  return notes;
}

/// One line, such as "298 whole frames, 2 in part, 0 dropped; 35 of 72600 packets lost (0.05 %)".
void print(const PacketCounts& counts, std::size_t microframes) {
  std::cout << counts.whole_frames << " whole frames, " << counts.partial_frames << " in part, "
            << counts.dropped_frames << " dropped; " << counts.lost_packets << " of "
            << counts.packets << " packets lost (" << std::fixed << std::setprecision(2)
            << 100 * counts.lost_share() << " %); " << microframes << " microframes recorded"
            << std::endl;
}

/// Reads a frame. A sensor that sends none is what a recording of its USB is for.
/// @return false if stopped first
bool read_or_wait(DepthSensor& sensor, const std::stop_token& stop) try {
  return sensor.read(stop).has_value();
} catch (const Error& error) {
  if (error.code() != ErrorCode::sensor_silent) {
    throw;
  }
  return true;
}

/// Reads frames for that long. @return false if stopped first
bool read_for(std::chrono::seconds duration, DepthSensor& sensor, const std::stop_token& stop) {
  const auto end = Clock::now() + duration;
  while (Clock::now() < end) {
    if (!read_or_wait(sensor, stop)) {
      return false;
    }
  }
  return true;
}

}  // namespace

UsbRecording::UsbRecording(DepthSensor& sensor, const RecordArguments& arguments)
    : sensor_(sensor),
      logger_(dynamic_cast<PacketLogger*>(&sensor)),
      file_(arguments.usb),
      before_(sensor.packet_counts()) {
  const AtomicFile probe(file_);  // its destructor removes the temporary file
  if (logger_ == nullptr || !logger_->log_packets(arguments.usb_seconds * microframes_per_second)) {
    throw Error(ErrorCode::sensor_other, "--usb: packets of this sensor cannot be recorded",
                "Only those of a Kinect can: --sensor kinect://.");
  }
}

void UsbRecording::write() {
  const std::vector<UsbPacket> packets = logger_->take_logged_packets();
  const auto after = sensor_.packet_counts();
  write_file(file_, to_usb_log_text(packets, notes_on_machine(sensor_)));
  print(after && before_ ? *after - *before_ : PacketCounts(), packets.size());
}

void record_usb(const RecordArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions options = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  const std::stop_token stop = signal.token();
  Rig rig(options);
  UsbRecording recording(rig.sensor(), arguments);
  if (!read_for(std::chrono::seconds(arguments.usb_seconds), rig.sensor(), stop)) {
    throw_stopped("no recording was written");
  }
  recording.write();
}

std::optional<std::string> usb_log_text(DepthSensor& sensor, std::chrono::seconds duration,
                                        const std::stop_token& stop) {
  auto* const logger = dynamic_cast<PacketLogger*>(&sensor);
  const int count = static_cast<int>(duration.count()) * microframes_per_second;
  if (logger == nullptr || !logger->log_packets(count) || !read_for(duration, sensor, stop)) {
    return std::nullopt;
  }
  return to_usb_log_text(logger->take_logged_packets(), notes_on_machine(sensor));
}

}  // namespace octurn
