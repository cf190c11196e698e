#include "octurn/calibrate.hpp"

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/commands.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "scan/scan_settings.hpp"
#include "scan/solve_pose.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"

namespace octurn {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Eigen::Isometry3d& pose) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return rows;
}

Json to_json(const CalibrationFinding& finding) {
  Json json{{"code", finding.code}, {"detail", finding.detail}, {"hint", finding.hint}};
  if (finding.stop) {
    json["stop"] = *finding.stop;
  }
  if (finding.angle) {
    json["deg"] = degrees_from_radians(*finding.angle);
  }
  return json;
}

Json to_json(const CalibrationReport& report, const Scan& scan) {
  Json stops = Json::array();
  for (std::size_t stop = 0; stop < report.stop_offsets.size(); ++stop) {
    stops.push_back({{"angle_deg", degrees_from_radians(scan.shots[stop].angle)},
                     {"off_deg", degrees_from_radians(report.stop_offsets[stop])}});
  }
  Json findings = Json::array();
  for (const CalibrationFinding& finding : report.findings) {
    findings.push_back(to_json(finding));
  }
  return {{"accepted", report.accepted},
          {"reason", report.reason},
          {"platform_from_sensor",
           report.accepted ? to_json(report.platform_from_sensor) : Json(nullptr)},
          {"shift_mm", mm_from_metres(report.shift)},
          {"tilt_deg", degrees_from_radians(report.tilt)},
          {"sigma_mm", mm_from_metres(report.position_sigma)},
          {"sigma_deg", degrees_from_radians(report.direction_sigma)},
          {"before_mm", mm_from_metres(report.before)},
          {"after_mm", mm_from_metres(report.after)},
          {"stops", std::move(stops)},
          {"findings", std::move(findings)}};
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
  const Scan scan = read_scan(arguments.folder);
  const CalibrationReport report =
      solve_pose(arguments.folder, scan, available_threads(), signal.token());
  if (arguments.apply && report.accepted) {
    write_solved_pose(arguments.folder, to_solved_pose(report));
  }
  write_standard_output(arguments.json ? to_json(report, scan).dump() + "\n" : to_text(report));
  return report.accepted;
} catch (const Stopped&) {
  throw_stopped("nothing was solved");
}

}  // namespace octurn
