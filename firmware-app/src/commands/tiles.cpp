#include "octurn/tiles.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands/model_commands.hpp"
#include "commands/reconstruct_input.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/units.hpp"
#include "process.hpp"
#include "progress_bar.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"

namespace octurn {
namespace {

using Json = nlohmann::ordered_json;

/// @throws Error "bad-settings"  if the scan was made on a turntable, which is not tiled
ModelInput read_tiled_input(const ReconstructArguments& arguments) {
  ModelInput input = read_input(arguments).model;
  if (!has_free_poses(input.scan)) {
    throw Error(ErrorCode::bad_settings,
                arguments.folder.string() + ": has no tiles: it is a scan on the turntable",
                "Make its model whole, by octurn reconstruct -o.");
  }
  if (input.options.edits != ModelEdits{} || input.options.solid.max_triangles) {
    throw Error(ErrorCode::bad_settings, "tiles are not cut, erased, laid, scaled or limited",
                "Make the model whole, by octurn reconstruct -o, to lay or scale it.");
  }
  fit_to_scan(input.options, input.scan);
  return input;
}

Json to_json(const TilePlan& plan, const ReconstructOptions& options) {
  Json tiles = Json::array();
  for (const Tile& tile : plan.tiles) {
    tiles.push_back(
        {{"tile", tiles.size()},
         {"index", {tile.index.x, tile.index.y, tile.index.z}},
         {"snapshots", tile.snapshots.size()},
         {"megabytes", mb_from_bytes(static_cast<double>(tile_memory(options, tile)))}});
  }
  return {{"tiles", std::move(tiles)}};
}

}  // namespace

void plan_tiles(const TileArguments& arguments) try {
  const SignalStop signal;
  const ModelInput input = read_tiled_input(arguments.model);
  ProgressBar bar;
  const TilePlan plan = plan_tiles(
      input.options, shown_snapshots(arguments.model.folder, input.scan, bar, signal.token()),
      signal.token());
  if (!arguments.model.output.empty()) {
    write_plan(plan, input.options, arguments.model.output);
  }
  write_standard_output(to_json(plan, input.options).dump() + "\n");
} catch (const Stopped&) {
  throw_stopped("nothing was planned");
}

void make_tile(const TileArguments& arguments) try {
  const SignalStop signal;
  const ModelInput input = read_tiled_input(arguments.model);
  ProgressBar bar;
  const SnapshotSource snapshots =
      shown_snapshots(arguments.model.folder, input.scan, bar, signal.token());
  const TilePlan plan = arguments.plan_file ? read_plan(*arguments.plan_file, input.options)
                                            : plan_tiles(input.options, snapshots, signal.token());
  write_tile(input.options, plan, *arguments.tile, snapshots, arguments.model.output,
             signal.token());
} catch (const Stopped&) {
  throw_stopped("no tile was written");
}

void join(const JoinArguments& arguments) try {
  return_freed_memory();
  const SignalStop signal;
  expect_writable(arguments.output);
  const ModelReport report = join_tiles(arguments.tiles, arguments.output, signal.token());
  if (arguments.json) {
    write_standard_output(Json{{"leaves", report.leaves},
                               {"triangles", report.triangles},
                               {"watertight", report.watertight}}
                              .dump() +
                          "\n");
  }
} catch (const Stopped&) {
  throw_stopped("no model was written");
}

}  // namespace octurn
