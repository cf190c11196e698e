#include "commands/model_commands.hpp"

#include <CLI/CLI.hpp>

#include "commands/options.hpp"
#include "mesh/mesh_formats.hpp"

namespace octurn {
namespace {

/// Runs `octurn reconstruct`, which makes a model, a plan or a tile.
void run_reconstruct(const TileArguments& arguments) {
  if (arguments.plan) {
    plan_tiles(arguments);
  } else if (arguments.model.output.empty()) {
    throw CLI::RequiredError("--output");
  } else if (arguments.tile) {
    make_tile(arguments);
  } else {
    reconstruct(arguments.model);
  }
}

}  // namespace

CLI::Option* add_sensor_map_option(CLI::App& command,
                                   std::optional<std::filesystem::path>& sensor_map) {
  return command
      .add_option("--sensor-map", sensor_map,
                  "map of the sensor's own error, as --wall of `octurn calibrate` makes it (the "
                  "folder's sensor-map.png)")
      ->type_name("MAP");
}

void add_reconstruct(CLI::App& program, TileArguments& arguments) {
  CLI::App& command = *program.add_subcommand("reconstruct", "a model from a scan folder");
  command.add_option("SCAN_DIR", arguments.model.folder, "folder with a scan.json")->required();
  command
      .add_option("-o,--output", arguments.model.output,
                  "the model, binary STL in millimetres; - is standard output. With --tile the "
                  "tile, with --plan the plan for --plan-file")
      ->type_name("FILE");
  ModelSettings defaults;
  add_options(command, fields(defaults), arguments.model.settings);
  add_sensor_map_option(command, arguments.model.sensor_map);
  CLI::Option* const json =
      command.add_flag("--json", arguments.model.json,
                       "print one line of JSON on standard output, or on standard error with -o -");
  CLI::Option* const plan =
      command
          .add_flag("--plan", arguments.plan,
                    "of a scan with free poses: print the tiles, each with what it takes, as one "
                    "line of JSON; make none")
          ->excludes(json);
  CLI::Option* const tile =
      command
          .add_option("--tile", arguments.tile, "make this tile of the plan alone, for octurn join")
          ->type_name("K")
          ->excludes(json)
          ->excludes(plan);
  command
      .add_flag("--colour", arguments.model.colour,
                "of a scan by laser line: the model with the colours of its pictures, to a FILE "
                "that ends with " +
                    mesh_file_names(""))
      ->excludes(plan)
      ->excludes(tile);
  command
      .add_option("--plan-file", arguments.plan_file,
                  "the plan as --plan -o wrote it: without it each --tile makes it anew")
      ->type_name("FILE")
      ->needs(tile);
  command.callback([&] { run_reconstruct(arguments); });
}

void add_join(CLI::App& program, JoinArguments& arguments) {
  CLI::App& command = *program.add_subcommand(
      "join", "a model from all tiles of a scan, as octurn reconstruct --tile makes them");
  command.add_option("TILE", arguments.tiles, "the tiles, in any order")->required();
  command.add_option("-o,--output", arguments.output, "the model, binary STL in millimetres")
      ->type_name("FILE")
      ->required();
  command.add_flag("--json", arguments.json, "print one line of JSON on standard output");
  command.footer("The bytes are those that octurn reconstruct makes of the whole scan.");
  command.callback([&arguments] { join(arguments); });
}

void add_build(CLI::App& program, std::filesystem::path& folder) {
  CLI::App& command = *program.add_subcommand(
      "build", "a model that octurn serve --builds-by slurm has ordered: what its jobs run");
  command.add_option("DIR", folder, "folder with a task.json, which gets the model")->required();
  command.callback([&folder] { build_ordered(folder); });
}

void add_import(CLI::App& program, ImportArguments& arguments) {
  CLI::App& import =
      *program.add_subcommand("import", "a scan folder from another program's files");
  import.require_subcommand(1);
  CLI::App& command = *import.add_subcommand(
      "tum", "from a folder in the layout of TUM's RGB-D data sets: depth.txt, groundtruth.txt");
  command.add_option("DIR", arguments.folder, "folder with a depth.txt")->required();
  command.add_option("-o,--output", arguments.output, "scan folder to write; must not exist yet")
      ->type_name("SCAN_DIR")
      ->required();
  command
      .add_option(
          "--intrinsics", arguments.camera,
          "the camera: freiburg1, freiburg2, freiburg3, icl-nuim, default, or FX,FY,CX,CY in "
          "pixels; a negative FY if its Y points up (as the folder's name tells, else default)")
      ->type_name("CAMERA");
  command.add_option("--every", arguments.every, "take one of so many depth images (1)")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000));
  command
      .add_option("--depth-unit-m", arguments.depth_unit,
                  "unit of the depth images, such as 0.001 (0.0002, or what their agreement tells)")
      ->type_name("METRES")
      ->check(CLI::Range(1e-6, 1.0));
  command
      .add_option("--max-gap-s", arguments.max_gap,
                  "longest time between two poses to interpolate between (0.1)")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 3600.0));
  command.footer(
      "Poses are interpolated to the time of each depth image; an image without poses near its "
      "time is left out.");
  command.callback([&arguments] { import_tum(arguments); });
}

}  // namespace octurn
