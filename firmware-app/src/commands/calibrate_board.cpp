#include <algorithm>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <vector>

#include "calibration/board_pdf.hpp"
#include "calibration/lens_files.hpp"
#include "commands/commands.hpp"
#include "commands/follow_calibration.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/lens.hpp"
#include "octurn/optics_json.hpp"
#include "octurn/png.hpp"
#include "octurn/units.hpp"
#include "progress_bar.hpp"
#include "run/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "store/data_folder.hpp"

namespace octurn {
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

CalibrationRun run_of_rig(const CalibrateBoardArguments& arguments) {
  const Config config = make_config(arguments.config);
  const RigOptions rig = rig_options(arguments.rig, config);
  const SignalStop signal;
  ScanStore store(config.data);
  load_sensor_drivers();  // changes the working directory: before the first thread
  Scanner scanner(rig, config.limits, store);
  scanner.expect_ready();
  scanner.look_at_board(metres_from_mm(
      arguments.square_mm));  // cannot be refused as busy: this process does nothing else
  const CalibrationRun run = follow_calibration(scanner, signal.token(), show_advice);
  if (run.failure) {
    throw to_error(*run.failure);
  }
  if (!run.lens) {
    throw_stopped("nothing was solved");
  }
  if (run.lens->accepted) {
    scanner.keep_lens();
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

}  // namespace octurn
