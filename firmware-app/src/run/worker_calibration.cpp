// Worker: measurements of the rig: the sensor's pose by a turn, its depth error by a wall.

#include <array>
#include <utility>

#include "calibration/sensor_map_files.hpp"
#include "capture/measure_laser_turn.hpp"
#include "capture/wall_views.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/sensor_map.hpp"
#include "run/worker.hpp"

namespace octurn {
namespace {

/// Makes the record of an accepted turn. A confirmed pose is the configured one, bit for bit.
PoseRecord to_record(const TurnReport& report, const ScanSettings& settings, Rig& rig) {
  if (rig.laser() == nullptr) {
    PoseRecord record = to_record(report.calibration, PoseOrigin::turn, settings.depth_scale);
    if (!report.replaces_told) {
      record.platform_from_sensor = settings.platform_from_sensor;
    }
    return record;
  }
  PoseRecord record = to_record(report.calibration, PoseOrigin::turn, rig.camera().serial(),
                                report.replaces_told ? report.lasers : report.told);
  if (!report.replaces_told) {
    record.platform_from_sensor = rig.laser()->platform_from_sensor;
  }
  return record;
}

/// Reads the map of the sensor's depth error; nullopt if this machine has none of the frames' size.
/// @throws Error "scan-malformed"
std::optional<SensorMap> find_sensor_map(const std::filesystem::path& data, std::string_view serial,
                                         const Intrinsics& lens) {
  const std::filesystem::path file = sensor_map_path(data, serial);
  if (serial.empty() || !std::filesystem::exists(file)) {
    return std::nullopt;
  }
  SensorMap map = read_sensor_map(file);
  return map.width == lens.width && map.height == lens.height ? std::optional(std::move(map))
                                                              : std::nullopt;
}

/// Describes the outcome of a run, for the log.
std::string describe_outcome(const CalibrationRun& run) {
  const std::string reason = run.report ? run.report->calibration.reason
                             : run.wall ? run.wall->reason
                             : run.lens ? run.lens->reason
                                        : "";
  switch (run.state) {
    case CalibrationRun::State::done:
      return "accepted";
    case CalibrationRun::State::refused:
      return "refused: " + reason;
    default:
      return "cancelled";
  }
}

}  // namespace

void Worker::carry_out(CalibrateCommand& command, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::turn, .stops = command.settings.snapshots},
            [&](CalibrationRun& run) { measure(run, command.settings, stop.get_token()); });
}

void Worker::carry_out(WallCommand& command, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::wall,
             .phase = CalibrationRun::Phase::looking,
             .stops = command.frames},
            [&](CalibrationRun& run) { measure_wall(run, stop.get_token()); });
}

/// Runs a measurement, and publishes its state.
/// @param measurement  sets its outcome in `run`
void Worker::carry_out(CalibrationRun run,
                       const std::function<void(CalibrationRun& run)>& measurement) {
  ports_.board.drop_waiting_build(displaced_by_scan());  // this command replaced it
  constexpr std::array<const char*, 3> names{"turn", "wall", "lens"};
  const std::string name = names[static_cast<std::size_t>(run.kind)];
  log::info("calibration", name + " started, of=" + std::to_string(run.stops));
  try {
    measurement(run);
    log::info("calibration", name + " " + describe_outcome(run));
  } catch (...) {
    run.failure = current_failure();
    run.state = CalibrationRun::State::failed;
    log::error("calibration", run.failure->detail);
    close_device(*run.failure);
  }
  release_rig();
  const std::lock_guard lock(ports_.scans);
  if (run.lens && run.lens->accepted) {
    ports_.solved_lens = SolvedLens{.camera = run.camera, .report = *run.lens};
  }
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_calibration_run(std::move(run));
}

/// Measures a turn, and puts the solved pose into force if it is accepted.
void Worker::measure(CalibrationRun& run, const ScanSettings& settings,
                     const std::stop_token& stop) {
  const ScanObserver observer{
      .on_progress =
          [&](Phase phase, int done) {
            run.stop = done;
            run.phase = phase == Phase::calibrating ? CalibrationRun::Phase::solving
                                                    : CalibrationRun::Phase::turning;
            ports_.board.set_calibration_run(run);
            begin(phase);
          },
      .on_turn = [this](double angle_deg) { save_platform_angle(angle_deg); },
      .on_frame = [this](const DepthFrame& frame) { show_frame(frame); }};
  run.report = measure_turn(settings, stop, observer);
  if (!run.report) {
    run.state = CalibrationRun::State::cancelled;
    return;
  }
  const TurnReport& report = *run.report;
  if (report.calibration.accepted) {
    ports_.calibration.set(to_record(report, settings, rig_));
  }
  run.state =
      report.calibration.accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
}

/// @return nullopt if stopped first
std::optional<TurnReport> Worker::measure_turn(const ScanSettings& settings,
                                               const std::stop_token& stop,
                                               const ScanObserver& observer) {
  if (rig_.laser() != nullptr) {
    use_lens("");
    use_pose();
    return measure_laser_turn(settings, ports_.store.data(), limits_.threads, rig_, stop, observer);
  }
  const std::optional<SensorMap> map =
      find_sensor_map(ports_.store.data(), rig_.sensor().serial(), rig_.sensor().intrinsics());
  return octurn::measure_turn(settings, map ? &*map : nullptr, limits_.threads, rig_, stop,
                              observer);
}

/// Reads frames of a wall, and stores the sensor's map if it is accepted.
void Worker::measure_wall(CalibrationRun& run, const std::stop_token& stop) {
  ports_.heartbeat.suspend();  // this takes as long as its frames
  DepthSensor& sensor = rig_.sensor();
  const std::string serial = sensor.serial();
  if (serial.empty()) {
    throw Error(
        ErrorCode::bad_settings, sensor.name() + ": reports no serial number",
        "A map belongs to one sensor. Make it of a recording with octurn calibrate --wall.");
  }
  const auto show = [&](const DepthFrame& frame, int frames) {
    run.stop = frames;
    ports_.board.set_calibration_run(run);
    show_frame(frame);
    ports_.heartbeat.suspend();
  };
  const std::filesystem::path data = ports_.store.data();
  const std::optional<WallView> view =
      look_at_wall(sensor, run.stops, next_wall(data, serial), stop, show);
  if (!view) {
    run.state = CalibrationRun::State::cancelled;
    return;
  }
  run.phase = CalibrationRun::Phase::solving;
  ports_.board.set_calibration_run(run);
  run.wall = add_wall(data, serial, *view);
  run.state = run.wall->accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
  introduced_.reset();
  introduce_sensor();
}

/// Publishes the open sensor's serial number, map and lens, once after each opening.
void Worker::introduce_sensor() {
  const auto since = rig_.sensor_since();
  if (!since || since == introduced_) {
    return;
  }
  introduced_ = since;
  const bool is_camera = rig_.laser() != nullptr;
  KnownSensor known{.serial = is_camera ? rig_.camera().serial() : rig_.sensor().serial(),
                    .since = since};
  try {
    known.map = find_map_summary(ports_.store.data(), known.serial);
    known.lens = is_camera ? octurn::find_lens(ports_.store.data(), known.serial) : std::nullopt;
  } catch (...) {
    log::warning("calibration", current_failure().detail);
  }
  ports_.devices.update([&](DeviceStates& devices) { devices.serial = known.serial; });
  ports_.board.set_known_sensor(std::move(known));
}

}  // namespace octurn
