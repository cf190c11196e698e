#include "commands/calibrate_options.hpp"

#include <CLI/CLI.hpp>

#include "calibration/board_pdf.hpp"
#include "commands/model_commands.hpp"
#include "commands/options.hpp"

namespace octurn {
namespace {

/// The command's options that need or make a printed board.
struct BoardOptions {
  CLI::Option* board = nullptr;
  CLI::Option* print = nullptr;
};

BoardOptions add_board_options(CLI::App& command, CalibrateBoardArguments& arguments) {
  CLI::Option* board =
      command
          .add_option("--board", arguments.folder,
                      "find the lens of a camera with lasers: from the 8-bit PNGs of a printed "
                      "board in this folder, or from a board that is held before the rig's "
                      "camera; or the optics of the rig's Kinect, likewise")
          ->type_name("[=DIR]")
          ->expected(0, 1);
  command
      .add_option("--keep", arguments.keep,
                  "keep what was found in DIR as the lens of the camera of this serial number, for "
                  "scans to come")
      ->type_name("SERIAL")
      ->needs(board);
  command
      .add_option("--square-mm", arguments.square_mm,
                  "side of the board's squares, as measured, for a Kinect (15)")
      ->type_name("MM")
      ->check(CLI::Range(min_board_square_mm, max_board_square_mm))
      ->needs(board);
  CLI::Option* print = command
                           .add_option("--print-board", arguments.pdf,
                                       "write such a board as a PDF, to be printed at 100 %")
                           ->type_name("FILE")
                           ->excludes(board);
  command.add_option("--paper", arguments.paper, "of that PDF (a4)")
      ->type_name("a4|letter")
      ->check(CLI::IsMember({"a4", "letter"}))
      ->needs(print);
  return {.board = board, .print = print};
}

}  // namespace

void add_calibrate(CLI::App& program, CalibrateOptions& options, int& status) {
  CLI::App& command =
      *program.add_subcommand("calibrate",
                              "finds the sensor's pose from a turn or a stored scan, its own error "
                              "from walls, or a camera's lens from a printed board");
  CLI::Option* folder =
      command.add_option("SCAN_DIR", options.pose.folder,
                         "folder with a scan.json; without it the platform is turned");
  CLI::Option* apply = command.add_flag(
      "--apply", options.pose.apply, "write what is accepted into scan.json, for models to come");
  apply->needs(folder);
  CLI::Option* map = add_sensor_map_option(command, options.pose.sensor_map)->needs(folder);
  add_rig_options(command, options.pose.rig, options.pose.config);
  add_config_options(command, options.pose.config);
  CLI::Option* stops = command.add_option("--stops", options.pose.stops, "stops of the turn (24)")
                           ->type_name("N")
                           ->check(CLI::Range(min_calibration_stops, max_calibration_stops))
                           ->excludes(folder);
  CLI::Option* wall =
      command
          .add_option("--wall", options.wall.walls,
                      "looks at a bare wall, as `octurn record --wall` makes them: make a map of "
                      "the sensor's own error from them")
          ->type_name("WALL_DIR")
          ->expected(1, 100)
          ->excludes(folder)
          ->excludes(apply)
          ->excludes(map)
          ->excludes(stops);
  CLI::Option* output =
      command.add_option("-o,--output", options.wall.output, "file for the map, a PNG")
          ->type_name("MAP")
          ->needs(wall);
  wall->needs(output);
  const BoardOptions of_board = add_board_options(command, options.board);
  for (CLI::Option* other : {folder, apply, map, stops, wall}) {
    of_board.board->excludes(other);
    of_board.print->excludes(other);
  }
  command.add_flag("--json", options.pose.json, "print one line of JSON in place of text");
  command.footer("It ends with 0 if what it found is accepted, with 1 if it is not.");
  command.callback([&, wall, of_board] {
    if (of_board.print->count() > 0) {
      print_board(options.board);
    } else if (of_board.board->count() > 0) {
      options.board.json = options.pose.json;
      options.board.rig = options.pose.rig;
      options.board.config = options.pose.config;
      status = calibrate_board(options.board) ? 0 : 1;
    } else if (wall->count() > 0) {
      options.wall.json = options.pose.json;
      status = calibrate_wall(options.wall) ? 0 : 1;
    } else {
      status = calibrate(options.pose) ? 0 : 1;
    }
  });
}

}  // namespace octurn
