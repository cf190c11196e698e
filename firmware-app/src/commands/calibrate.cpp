#include "octurn/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "calibration/solve_pose.hpp"
#include "commands/commands.hpp"
#include "commands/follow_calibration.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "run/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "settings/scan_settings.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "store/calibration_json.hpp"

namespace octurn {
namespace {

std::vector<double> stop_angles(const Scan& scan) {
  std::vector<double> angles;
  for (const Shot& shot : scan.shots) {
    angles.push_back(shot.angle);
  }
  return angles;
}

/// The report as lines for people.
std::string to_text(const CalibrationReport& report) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  if (!report.accepted) {
    text << "The configured pose stays in use: " << report.reason << ".\n";
  } else {
    text << "The axis is " << mm_from_metres(report.shift) << " mm and "
         << degrees_from_radians(report.tilt) << " degrees from the configured place, the platform "
         << mm_from_metres(report.lift) << " mm.\n"
         << "Known to " << mm_from_metres(report.position_sigma) << " mm and "
         << degrees_from_radians(report.direction_sigma) << " degrees"
         << (report.confirms_told() ? ": the configured pose is right" : "") << ".\n"
         << "Two stops disagree about the object by " << mm_from_metres(report.after)
         << " mm; with the configured pose, by " << mm_from_metres(report.before) << " mm.\n";
  }
  if (report.optics_differ) {
    const SensorOptics& seen = report.optics->value;
    const SensorOptics& sigma = report.optics->sigma;
    text << "The sensor's optics are not its data sheet's: focal length " << seen.fx << " +- "
         << sigma.fx << " pixels, middle at " << seen.cx << " +- " << sigma.cx << ", " << seen.cy
         << " +- " << sigma.cy << ", k1 " << seen.k1 << " +- " << sigma.k1 << ".\n";
  }
  for (const CalibrationFinding& finding : report.findings) {
    text << finding.code << ": " << finding.detail << ". " << finding.hint << '\n';
  }
  return text.str();
}

/// The angle between each laser's configured and solved plane, as lines for people.
std::string to_text(const std::vector<Laser>& configured, const std::vector<Laser>& solved) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(3);
  for (std::size_t i = 0; i < solved.size(); ++i) {
    const double turn =
        std::acos(std::clamp(configured[i].normal.dot(solved[i].normal), -1.0, 1.0));
    text << "The plane of laser " << solved[i].name << " is " << degrees_from_radians(turn)
         << " degrees from the configured one.\n";
  }
  return text.str();
}

/// @param configured, solved  lasers before and after solving; empty for a depth sensor
void write_calibration_report(const CalibrationReport& report, const std::vector<double>& angles,
                              const std::vector<Laser>& configured,
                              const std::vector<Laser>& solved,
                              const CalibrateArguments& arguments) {
  if (arguments.json) {
    const nlohmann::json object =
        solved.empty() ? to_json(report, angles) : to_json(report, angles, solved);
    write_standard_output(object.dump() + "\n");
  } else {
    write_standard_output(to_text(report) + (report.accepted ? to_text(configured, solved) : ""));
  }
}

bool calibrate_from(const std::filesystem::path& folder, const CalibrateArguments& arguments) {
  const SignalStop signal;
  Scan scan = read_scan(folder);
  scan.solved.reset();
  if (arguments.sensor_map) {
    use_sensor_map(scan, *arguments.sensor_map);
  }
  const std::stop_token stop = signal.token();
  const ScanSolution solution =
      solve_scan(folder, scan, stored_snapshots(folder, scan, stop), available_threads(), stop);
  const bool accepted = solution.report.accepted;
  if (arguments.apply && accepted) {
    write_solved_pose(folder, solution.solved, solution.report.slipped);
  }
  write_calibration_report(solution.report, stop_angles(scan),
                           scan.laser ? scan.laser->lasers : std::vector<Laser>(),
                           solution.solved.lasers, arguments);
  return accepted;
}

void show_turn(ProgressBar& bar, const CalibrationRun& run) {
  bar.show(run.stop, run.stops,
           run.phase == CalibrationRun::Phase::solving ? "solving" : "turning");
}

bool calibrate_rig(const CalibrateArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions rig = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  ScanStore store(config.data);
  Scanner scanner(rig, config.limits, store);
  ScanSettings settings = scanner.calibration().in_force(config.scan);
  settings.snapshots = arguments.stops;
  scanner.expect_ready();
  scanner.calibrate(settings);  // cannot be refused as busy: this process does nothing else
  const CalibrationRun run = follow_calibration(scanner, signal.token(), show_turn);
  if (run.failure) {
    throw to_error(*run.failure);
  }
  if (!run.report) {
    throw Stopped{};
  }
  const TurnReport& report = *run.report;
  write_calibration_report(report.calibration, report.angles, report.configured, report.lasers,
                           arguments);
  return report.calibration.accepted;
}

}  // namespace

bool calibrate(const CalibrateArguments& arguments) try {
  return arguments.folder ? calibrate_from(*arguments.folder, arguments) : calibrate_rig(arguments);
} catch (const Stopped&) {
  throw_stopped("nothing was solved");
}

}  // namespace octurn
