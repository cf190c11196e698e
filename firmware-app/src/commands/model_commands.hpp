#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commands/commands.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace octurn {

// Commands that reconstruct models, whole or tile by tile, and that import other programs'
// recordings.

struct TileArguments {
  ReconstructArguments model = {};                      ///< its output is a model, plan or tile
  bool plan = false;                                    ///< prints the tiles; makes none
  std::optional<std::size_t> tile = {};                 ///< index of the only tile to make
  std::optional<std::filesystem::path> plan_file = {};  ///< output of an earlier run with `plan`
};

/// `octurn reconstruct --plan`: prints the tiles of a scan with free poses as a line of JSON, and
/// writes the plan to the output if one is given.
void plan_tiles(const TileArguments& arguments);

/// `octurn reconstruct --tile`: makes one tile.
void make_tile(const TileArguments& arguments);

struct JoinArguments {
  std::vector<std::filesystem::path> tiles = {};
  std::filesystem::path output = {};
  bool json = false;  ///< one line of JSON on standard output
};

/// `octurn join`: joins all tiles of a scan into a model.
void join(const JoinArguments& arguments);

/// `octurn build`: builds the task that `octurn serve --builds-by slurm` has written to a folder.
void build_ordered(const std::filesystem::path& folder);

struct ImportArguments {
  std::filesystem::path folder = {};
  std::filesystem::path output = {};      ///< scan folder to write
  std::string camera = {};                ///< name or "FX,FY,CX,CY"; empty: from the folder's name
  int every = 1;                          ///< takes every n-th depth image
  double max_gap = 0.1;                   ///< seconds, between two poses to interpolate between
  std::optional<double> depth_unit = {};  ///< metres; nothing: 1/5000 m, or what the images tell
};

/// `octurn import tum`: makes a scan folder of a recording in the layout of TUM's RGB-D data sets.
void import_tum(const ImportArguments& arguments);

/// Adds the commands. The arguments outlive the parsing.
void add_reconstruct(CLI::App& program, TileArguments& arguments);
void add_join(CLI::App& program, JoinArguments& arguments);
void add_build(CLI::App& program, std::filesystem::path& folder);
void add_import(CLI::App& program, ImportArguments& arguments);

/// @return the option --sensor-map
CLI::Option* add_sensor_map_option(CLI::App& command,
                                   std::optional<std::filesystem::path>& sensor_map);

}  // namespace octurn
