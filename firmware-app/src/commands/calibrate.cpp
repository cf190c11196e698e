#include "octurn/calibrate.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <stop_token>
#include <vector>

#include "calibration/board_pdf.hpp"
#include "calibration/lens_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/lens.hpp"
#include "octurn/optics_json.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "run/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "settings/scan_settings.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "store/data_folder.hpp"
#include "store/job_json.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

/// Waits until the scanner's calibration has ended, and cancels it when `stop` is requested.
/// @param show  called again and again to draw the progress
/// @return      the ended run
CalibrationRun follow_calibration(Scanner& scanner, const std::stop_token& stop,
                                  void (*show)(ProgressBar& bar, const CalibrationRun& run)) {
  using namespace std::chrono_literals;
  ProgressBar bar;
  while (scanner.status().busy()) {
    show(bar, **scanner.calibration_run());
    if (stop.stop_requested()) {
      scanner.cancel_calibration();
    }
    scanner.wait_until_done(100ms);
  }
  return **scanner.calibration_run();
}

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
  write_calibration_report(report.calibration, report.angles, report.configured_lasers,
                           report.lasers, arguments);
  return report.calibration.accepted;
}

}  // namespace

bool calibrate(const CalibrateArguments& arguments) try {
  return arguments.folder ? calibrate_from(*arguments.folder, arguments) : calibrate_rig(arguments);
} catch (const Stopped&) {
  throw_stopped("nothing was solved");
}

namespace {

constexpr std::size_t max_picture_bytes = std::size_t{256} << 20U;

/// The report as lines for people.
std::string to_text(const LensReport& report) {
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  if (!report.accepted) {
    text << "The lens is not known: " << report.reason << ".\n";
    return text.str();
  }
  const Intrinsics& lens = report.lens.intrinsics;
  const Intrinsics& sigma = report.sigma.intrinsics;
  text << "fx " << lens.fx << " +- " << sigma.fx << ", fy " << lens.fy << " +- " << sigma.fy
       << ", cx " << lens.cx << " +- " << sigma.cx << ", cy " << lens.cy << " +- " << sigma.cy
       << " pixels of " << lens.width << " x " << lens.height << ".\n";
  text.precision(4);
  text << "k1 " << report.lens.k1 << " +- " << report.sigma.k1 << ", k2 " << report.lens.k2
       << " +- " << report.sigma.k2 << ".\n";
  text.precision(3);
  text << report.corners << " corners of " << report.views << " pictures lie " << report.rms
       << " pixels from where this lens shows them.\n";
  return text.str();
}

/// The optics of a depth sensor as lines for people.
std::string to_text(const SolvedOptics& optics) {
  const SensorOptics& found = optics.value;
  const SensorOptics& sigma = optics.sigma;
  std::ostringstream text;
  text.setf(std::ios::fixed);
  text.precision(2);
  text << "Of the depth image: focal length " << found.fx << " +- " << sigma.fx
       << " pixels, middle at " << found.cx << " +- " << sigma.cx << ", " << found.cy << " +- "
       << sigma.cy << ".\n";
  text.precision(4);
  text << "Depths are " << found.depth_scale << " +- " << sigma.depth_scale
       << " times those that the sensor reports, with an offset of " << found.depth_offset_per_m
       << " +- " << sigma.depth_offset_per_m << " 1/m.\n"
       << "This holds from now on. Measure the pose again: octurn calibrate.\n";
  return text.str();
}

/// @param optics  of a depth sensor, if it is one
void write_lens_report(const LensReport& report, const std::optional<SolvedOptics>& optics,
                       const CalibrateBoardArguments& arguments) {
  if (!arguments.json) {
    write_standard_output(to_text(report) + (optics ? to_text(*optics) : ""));
    return;
  }
  nlohmann::json object = to_json(report);
  if (optics) {
    object["optics"] = to_json(*optics);
  }
  write_standard_output(object.dump() + "\n");
}

struct PictureSize {
  int width = 1;  // pixels
  int height = 1;
};

/// Reads the size from a PNG's header; 1 x 1 for a file without one, which fails to decode.
PictureSize read_size(std::string_view png) {
  constexpr std::size_t header = 24;  // bytes: signature, length and type of IHDR, width, height
  const auto number = [&](std::size_t first) {
    unsigned value = 0;
    for (std::size_t i = first; i < first + 4; ++i) {
      value = value << 8U | static_cast<unsigned char>(png[i]);
    }
    return static_cast<int>(std::min(value, 65535U));
  };
  return png.size() < header ? PictureSize{}
                             : PictureSize{.width = number(16), .height = number(20)};
}

std::vector<std::filesystem::path> pictures_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names_in(folder)) {
    if (name.ends_with(".png")) {
      files.push_back(folder / name);
    }
  }
  std::ranges::sort(files);
  if (files.empty()) {
    throw Error(ErrorCode::read_failed, folder.string() + ": holds no PNG",
                "Name a folder with pictures of a printed board, 8-bit PNGs.");
  }
  return files;
}

LensReport report_from(const std::filesystem::path& folder) {
  const SignalStop signal;
  const std::vector<std::filesystem::path> files = pictures_in(folder);
  std::vector<BoardView> views;
  PictureSize size;
  ProgressBar bar;
  for (const std::filesystem::path& file : files) {
    if (signal.token().stop_requested()) {
      throw_stopped("nothing was solved");
    }
    bar.show(static_cast<int>(views.size()), static_cast<int>(files.size()), "looking for a board");
    const std::string png = read_regular_file(file, max_picture_bytes).value_or("");
    size = views.empty() ? read_size(png) : size;
    views.push_back(find_board(
        decode_picture_png(file.string(), std::as_bytes(std::span(png)), size.width, size.height)));
  }
  return calibrate_lens(views, size.width, size.height);
}

/// The advice as the label of the progress bar.
std::string_view to_words(BoardAdvice advice) {
  constexpr std::array<std::string_view, 5> words{"show the board", "hold it still", "tilt it",
                                                  "show it at the picture's edges",
                                                  "hold it another way"};
  return words[static_cast<std::size_t>(advice)];
}

void show_advice(ProgressBar& bar, const CalibrationRun& run) {
  if (run.look) {
    bar.show(std::min(run.stop, run.stops), run.stops, to_words(run.look->advice));
  }
}

/// Only a Kinect's distances are measured by the board's squares. @throws Error "bad-settings"
void expect_no_square(const CalibrateBoardArguments& arguments) {
  if (arguments.square_mm) {
    throw Error(ErrorCode::bad_settings,
                "--square-mm: the lens that pictures show does not depend on the squares' side",
                "Leave --square-mm out, or leave out the folder, to measure the rig's Kinect.");
  }
}

CalibrationRun run_of_rig(const CalibrateBoardArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions rig = rig_options(arguments.rig, config);
  if (rig.kind() == SensorKind::laser_line) {
    expect_no_square(arguments);
  }
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  ScanStore store(config.data);
  Scanner scanner(rig, config.limits, store);
  scanner.expect_ready();
  scanner.look_at_board(metres_from_mm(arguments.square_mm.value_or(
      board_square_mm)));  // cannot be refused as busy: this process does nothing else
  const CalibrationRun run = follow_calibration(scanner, signal.token(), show_advice);
  if (run.failure) {
    throw to_error(*run.failure);
  }
  if (!run.lens) {
    throw_stopped("nothing was solved");
  }
  if (run.lens->accepted) {
    scanner.keep_lens(config.scan);
  }
  return run;
}

}  // namespace

bool calibrate_board(const CalibrateBoardArguments& arguments) {
  if (arguments.folder.empty()) {
    if (arguments.keep) {
      throw Error(ErrorCode::bad_settings,
                  "--keep: the lens of the rig's own camera is kept in any case",
                  "Name the folder of pictures, or leave --keep out.");
    }
    const CalibrationRun run = run_of_rig(arguments);
    write_lens_report(*run.lens, run.optics, arguments);
    return run.lens->accepted;
  }
  expect_no_square(arguments);
  const LensReport report = report_from(arguments.folder);
  if (report.accepted && arguments.keep && !arguments.keep->empty()) {
    keep_lens(make_config(arguments.config).data, *arguments.keep, report);
  }
  write_lens_report(report, {}, arguments);
  return report.accepted;
}

void print_board(const CalibrateBoardArguments& arguments) {
  write_file(arguments.pdf, board_pdf(*paper_named(arguments.paper)));
}

namespace {

double to_units(double inverse_depth) { return inverse_depth / disparity_unit; }

/// Views of walls, all by one sensor.
struct WallViews {
  std::vector<WallView> views = {};
  std::string sensor_serial = {};
};

WallView read_view(const std::filesystem::path& folder, const Wall& wall,
                   const std::stop_token& stop) {
  WallView view(wall.intrinsics, wall.sensor_on_for);
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
