// How the worker measures the sensor's pose with a turn.

#include <utility>

#include "log.hpp"
#include "octurn/sensor_map.hpp"
#include "scan/sensor_map_files.hpp"
#include "scan/worker.hpp"

namespace octurn {
namespace {

/// What is stored of an accepted report. A told pose that it confirms stays bit for bit.
PoseRecord to_record(const CalibrationReport& report, const ScanSettings& settings) {
  PoseRecord record = to_record(report, PoseOrigin::turn, settings.depth_scale);
  if (report.confirms_told()) {
    record.platform_from_sensor = settings.platform_from_sensor;
  }
  return record;
}

/// The map of the sensor's own error; nothing if this machine has none of its size.
/// @throws Error "scan-malformed"
std::optional<SensorMap> find_sensor_map(const std::filesystem::path& data, std::string_view serial,
                                         const Intrinsics& lens) {
  const std::filesystem::path file = sensor_map_of(data, serial);
  if (serial.empty() || !std::filesystem::exists(file)) {
    return std::nullopt;
  }
  SensorMap map = read_sensor_map(file);
  return map.width == lens.width && map.height == lens.height ? std::optional(std::move(map))
                                                              : std::nullopt;
}

}  // namespace

void Worker::carry_out(CalibrateCommand& command, const std::stop_source& stop) {
  CalibrationRun run{.stops = command.settings.snapshots};
  log::info("calibration", "turn started, stops=" + std::to_string(run.stops));
  try {
    measure(run, command.settings, stop.get_token());
  } catch (...) {
    run.failure = current_failure();
    run.state = CalibrationRun::State::failed;
    log::error("calibration", run.failure->detail);
    close_device(*run.failure);
  }
  release_rig();
  const std::lock_guard lock(ports_.scans);
  ports_.slot.finish();  // before anybody is told
  ports_.board.set_calibration_run(std::move(run));
}

/// Takes the turn, and puts what it tells into force if that is accepted.
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
  const std::optional<SensorMap> map =
      find_sensor_map(ports_.store.data(), rig_.sensor().serial(), rig_.sensor().intrinsics());
  run.report = measure_turn(settings, map ? &*map : nullptr, limits_.threads, rig_, stop, observer);
  if (!run.report) {
    run.state = CalibrationRun::State::cancelled;
    log::info("calibration", "turn cancelled");
    return;
  }
  const CalibrationReport& report = run.report->calibration;
  if (report.accepted) {
    ports_.calibration.set(to_record(report, settings));
  }
  run.state = report.accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
  log::info("calibration", report.accepted ? "turn accepted" : "turn refused: " + report.reason);
}

}  // namespace octurn
