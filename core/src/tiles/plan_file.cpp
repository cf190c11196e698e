#include "tiles/plan_file.hpp"

#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "io/checksum.hpp"
#include "io/pose_json.hpp"
#include "octurn/file.hpp"
#include "tiles/tile_lattice.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr ErrorCode malformed = ErrorCode::scan_malformed;

/// The options on which a plan depends.
json settings_json(const ReconstructOptions& options) {
  json settings{{"method", to_string(options.method)},
                {"root_size_m", options.root_size},
                {"leaf_size_m", TileLattice(options).leaf_side()},
                {"clip_m", to_json(options.clip)}};
  if (options.method == Method::intersection) {
    settings["threshold_m2"] = options.threshold;
  }
  return settings;
}

json tile_json(const Tile& tile) {
  return {{"index", {tile.index.x, tile.index.y, tile.index.z}},
          {"snapshots", tile.snapshots},
          {"bytes", tile.bytes}};
}

Tile tile_from(const JsonValue& value, int snapshots) {
  JsonObject keys(value);
  Tile tile{.index = tile_index_from(keys.at("index")),
            .bytes = static_cast<std::size_t>(keys.at("bytes").number(0, 1e15))};
  for (const JsonValue& snapshot : keys.at("snapshots").elements()) {
    tile.snapshots.push_back(static_cast<std::size_t>(snapshot.whole_number(0, snapshots - 1)));
  }
  return tile;
}

TilePlan plan_from(const json& document, const ReconstructOptions& options) {
  JsonObject keys(document, malformed, "");
  if (const JsonValue format = keys.at("format"); format.text() != "octurn-plan") {
    format.refuse("\"octurn-plan\"");
  }
  static_cast<void>(keys.at("version").whole_number(1, 1));
  if (keys.at("settings").json() != settings_json(options)) {
    throw Error(ErrorCode::scan_malformed, "was made with other settings",
                "Give the same options, or make the plan again.");
  }
  TilePlan plan;
  for (const JsonValue& checksum : keys.at("snapshots").elements()) {
    plan.snapshots.push_back(checksum_from(checksum));
  }
  for (const JsonValue& tile : keys.at("tiles").elements()) {
    plan.tiles.push_back(tile_from(tile, static_cast<int>(plan.snapshots.size())));
  }
  return plan;
}

}  // namespace

std::uint64_t compute_checksum(const Snapshot& snapshot) {
  Checksum checksum;
  checksum.add(std::as_bytes(std::span(snapshot.frame.depth)));
  const Eigen::Matrix4d pose = snapshot.object_from_sensor.matrix();
  checksum.add(std::as_bytes(std::span(pose.data(), static_cast<std::size_t>(pose.size()))));
  const Intrinsics& camera = snapshot.intrinsics;
  const std::array values{camera.fx, camera.fy, camera.cx, camera.cy, camera.depth_unit};
  checksum.add(std::as_bytes(std::span(values)));
  return checksum.value();
}

std::uint64_t compute_checksum(const TilePlan& plan) {
  Checksum checksum;
  checksum.add(std::as_bytes(std::span(plan.snapshots)));
  for (const Tile& tile : plan.tiles) {
    const std::array index{tile.index.x, tile.index.y, tile.index.z};
    checksum.add(std::as_bytes(std::span(index)));
  }
  return checksum.value();
}

TileIndex tile_index_from(const JsonValue& value) {
  const std::vector<JsonValue> index = value.elements(3);
  const auto at = [&](std::size_t axis) {
    return index[axis].whole_number(-TileLattice::max_index, TileLattice::max_index);
  };
  return {.x = at(0), .y = at(1), .z = at(2)};
}

std::uint64_t checksum_from(const JsonValue& value) {
  const std::string digits = value.text();
  std::uint64_t number = 0;
  const char* const end = digits.data() + digits.size();
  if (const auto read = std::from_chars(digits.data(), end, number);
      read.ec != std::errc() || read.ptr != end) {
    value.refuse("a checksum: digits");
  }
  return number;
}

void write_plan(const TilePlan& plan, const ReconstructOptions& options,
                const std::filesystem::path& file) {
  json document{{"format", "octurn-plan"},
                {"version", 1},
                {"settings", settings_json(options)},
                {"snapshots", json::array()},
                {"tiles", json::array()}};
  for (const std::uint64_t checksum : plan.snapshots) {
    document["snapshots"].push_back(std::to_string(checksum));
  }
  for (const Tile& tile : plan.tiles) {
    document["tiles"].push_back(tile_json(tile));
  }
  write_file(file, document.dump() + "\n");
}

TilePlan read_plan(const std::filesystem::path& file, const ReconstructOptions& options) {
  const auto text = read_regular_file(file, max_json_bytes);
  if (!text) {
    throw Error(ErrorCode::scan_missing, file.string() + ": there is no such plan",
                "Make it by octurn reconstruct --plan -o.");
  }
  try {
    return plan_from(parse_json(*text, malformed, "it", {.values = max_json_bytes}), options);
  } catch (const Error& error) {
    throw Error(error.code(), file.string() + ": " + error.what(), error.hint());
  }
}

}  // namespace octurn
