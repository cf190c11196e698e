#include "octurn/calibrate.hpp"

#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "commands/commands.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "scan/calibration_json.hpp"
#include "scan/scan_settings.hpp"
#include "scan/solve_pose.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"

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
    text << "The told pose stays: " << report.reason << ".\n";
  } else {
    text << "The axis is " << mm_from_metres(report.shift) << " mm and "
         << degrees_from_radians(report.tilt) << " degrees from where it was told, the platform "
         << mm_from_metres(report.lift) << " mm.\n"
         << "Known to " << mm_from_metres(report.position_sigma) << " mm and "
         << degrees_from_radians(report.direction_sigma) << " degrees"
         << (report.confirms_told() ? ": the told pose is right" : "") << ".\n"
         << "Two stops disagree about the object by " << mm_from_metres(report.after)
         << " mm; as told, by " << mm_from_metres(report.before) << " mm.\n";
  }
  for (const CalibrationFinding& finding : report.findings) {
    text << finding.code << ": " << finding.detail << ". " << finding.hint << '\n';
  }
  return text.str();
}

}  // namespace

bool calibrate(const CalibrateArguments& arguments) try {
  const SignalStop signal;
  Scan scan = read_scan(arguments.folder);
  if (arguments.sensor_map) {
    use_sensor_map(scan, *arguments.sensor_map);
  }
  const CalibrationReport report = solve_pose(
      scan, stored_snapshots(arguments.folder, scan, signal.token()), available_threads());
  if (arguments.apply && report.accepted) {
    write_solved_pose(arguments.folder, to_solved_pose(report));
  }
  write_standard_output(arguments.json ? to_json(report, stop_angles(scan)).dump() + "\n"
                                       : to_text(report));
  return report.accepted;
} catch (const Stopped&) {
  throw_stopped("nothing was solved");
}

}  // namespace octurn
