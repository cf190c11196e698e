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

/// The commands that make models, whole and tile by tile, and scans of what other programs
/// recorded.

struct TileArguments {
  ReconstructArguments model = {};                      ///< of the whole, but for its output
  bool plan = false;                                    ///< prints the tiles; makes none
  std::optional<std::size_t> tile = {};                 ///< makes this one alone
  std::optional<std::filesystem::path> plan_file = {};  ///< that the output of `plan` was
};

/// `octurn reconstruct --plan`: the tiles of a scan with free poses, as a line of JSON; and as a
/// file, if there is an output.
void plan_tiles(const TileArguments& arguments);

/// `octurn reconstruct --tile`: one of them.
void make_tile(const TileArguments& arguments);

struct JoinArguments {
  std::vector<std::filesystem::path> tiles = {};
  std::filesystem::path output = {};
  bool json = false;  ///< one line of JSON on standard output
};

/// `octurn join`: a model from all tiles of a scan.
void join(const JoinArguments& arguments);

/// `octurn build`: the build that `octurn serve --builds-by slurm` has ordered in a folder.
void build_ordered(const std::filesystem::path& folder);

struct ImportArguments {
  std::filesystem::path folder = {};
  std::filesystem::path output = {};  ///< scan folder to write
  std::string camera = {};            ///< a name or four numbers; empty: as the folder's name tells
  int every = 1;                      ///< takes one of so many depth images
};

/// `octurn import tum`: a scan folder from a recording in the layout of TUM's RGB-D data sets.
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
