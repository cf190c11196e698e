#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calibration/sensor_map_json.hpp"
#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "octurn/sensor_map.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

double to_units(double inverse_depth) { return inverse_depth / disparity_unit; }

/// Views of walls, all by one sensor.
struct WallViews {
  std::vector<WallView> views = {};
  std::string sensor_serial = {};
};

WallView read_view(const std::filesystem::path& folder, const Wall& wall,
                   const std::stop_token& stop) {
  WallView view(wall.intrinsics);
  for (std::size_t frame = 0; frame < wall.frames.size(); ++frame) {
    if (stop.stop_requested()) {
      throw_stopped("no map was written");
    }
    view.add(read_wall_frame(folder, wall, frame));
  }
  return view;
}

/// @throws Error "recording-malformed"  also if the folders are of several sensors
WallViews read_wall_views(const std::vector<std::filesystem::path>& folders,
                          const std::stop_token& stop) {
  WallViews walls;
  for (const std::filesystem::path& folder : folders) {
    const Wall wall = read_wall(folder);
    if (walls.views.empty()) {
      walls.sensor_serial = wall.sensor_serial;
    } else if (wall.intrinsics != walls.views.front().intrinsics() ||
               wall.sensor_serial != walls.sensor_serial) {
      throw Error(ErrorCode::recording_malformed, folder.string() + ": is of another sensor",
                  "Make a map from the walls of one sensor.");
    }
    walls.views.push_back(read_view(folder, wall, stop));
  }
  return walls;
}

/// The report as lines for people.
std::string to_text(const SensorMapReport& report) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  if (!report.accepted) {
    text << "No map was made: " << report.reason << ".\n";
    return text.str();
  }
  for (const WallReport& wall : report.walls) {
    text << "A wall " << wall.distance << " m away, seen on " << 100 * wall.coverage
         << " % of the picture: flat within " << to_units(wall.before)
         << " steps of disparity, with the map within " << to_units(wall.after) << ".\n";
  }
  return text.str();
}

}  // namespace

bool calibrate_wall(const CalibrateWallArguments& arguments) {
  const SignalStop signal;
  expect_writable(arguments.output);
  const WallViews walls = read_wall_views(arguments.walls, signal.token());
  SensorMapReport report = fit_sensor_map(walls.views);
  report.map.serial = walls.sensor_serial;
  if (report.accepted) {
    report.map.made = utc_text(std::chrono::system_clock::now(), rfc3339);
    write_sensor_map(arguments.output, report.map);
  }
  write_standard_output(arguments.json ? to_json(report).dump() + "\n" : to_text(report));
  return report.accepted;
}

}  // namespace octurn
