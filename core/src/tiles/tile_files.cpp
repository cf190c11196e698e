#include "tiles/tile_files.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "io/pose_json.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "tiles/tile_lattice.hpp"
#include "tsdf/shell.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::string_view first_line = "octurn-tile 1\n";
constexpr std::size_t max_header_bytes = 4096;

static_assert(std::endian::native == std::endian::little && sizeof(TileBrick) == 6,
              "positions and bricks are written as they lie in memory");

json to_json(const TileHeader& header) {
  const ReconstructOptions& options = header.options;
  json value{{"method", to_string(options.method)},
             {"root_size_m", options.root_size},
             {"leaf_size_m", options.leaf_size},
             {"clip_m", to_json(options.clip)},
             {"plan", std::to_string(header.plan)},
             {"tiles", header.tiles},
             {"tile", header.number},
             {"index", {header.index.x, header.index.y, header.index.z}},
             {"bricks", header.bricks}};
  if (options.method == Method::solid) {
    value["max_error_m"] = options.target_error;
  } else {
    value["threshold_m2"] = options.threshold;
  }
  return value;
}

/// @throws Error "scan-malformed"
TileHeader header_from(std::string_view text) {
  constexpr int most = 1 << 30;
  const json document = parse_json(text, ErrorCode::scan_malformed, "its second line");
  JsonObject keys(document, ErrorCode::scan_malformed, "");
  TileHeader header;
  ReconstructOptions& options = header.options;
  const JsonValue method = keys.at("method");
  const auto named = method_named(method.text());
  if (!named) {
    method.refuse("\"intersection\" or \"solid\"");
  }
  options.method = *named;
  options.root_size = keys.at("root_size_m").number(1e-6, 1e6);
  options.leaf_size = keys.at("leaf_size_m").number(1e-9, 1e6);
  options.clip = box_from(keys.at("clip_m"));
  if (options.method == Method::solid) {
    options.target_error = keys.at("max_error_m").number(0, 1e6);
  } else {
    options.threshold = keys.at("threshold_m2").number(0, 1e18);
  }
  header.plan = checksum_from(keys.at("plan"));
  header.tiles = static_cast<std::size_t>(keys.at("tiles").whole_number(1, most));
  header.number =
      static_cast<std::size_t>(keys.at("tile").whole_number(0, static_cast<int>(header.tiles) - 1));
  header.index = tile_index_from(keys.at("index"));
  header.bricks = static_cast<std::size_t>(keys.at("bricks").whole_number(0, most));
  return header;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorCode::scan_malformed, file.string() + ": " + what,
              "Make the tile again by octurn reconstruct --tile.");
}

std::ifstream open_tile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(ErrorCode::scan_missing, file.string() + ": cannot be read",
                "Make the tile by octurn reconstruct --tile.");
  }
  return stream;
}

/// @throws Error "scan-malformed"  unless the file ends with the checksum of all bytes before
void expect_whole(const std::filesystem::path& file, std::ifstream& stream, std::uint64_t size) {
  std::array<std::byte, std::size_t{1} << 16U> block{};
  Checksum checksum;
  const auto read = [&](std::span<std::byte> bytes) {
    if (!stream.read(reinterpret_cast<char*>(bytes.data()),
                     static_cast<std::streamsize>(bytes.size()))) {
      refuse(file, "is cut short");
    }
  };
  for (std::uint64_t left = size; left > 0;) {
    const auto bytes = std::span(block).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(left, block.size())));
    read(bytes);
    checksum.add(bytes);
    left -= bytes.size();
  }
  std::uint64_t stored = 0;
  read(std::as_writable_bytes(std::span(&stored, 1)));
  if (stored != checksum.value() || stream.peek() != std::ifstream::traits_type::eof()) {
    refuse(file, "is damaged: its checksum does not match");
  }
}

}  // namespace

std::size_t brick_bytes(Method method) {
  return method == Method::solid ? sizeof(ShellBrick) : sizeof(Brick);
}

std::uint64_t write_tile_bytes(const TileHeader& header, const TileBricks& tile,
                               const std::function<void(std::span<const std::byte>)>& write) {
  Checksum checksum;
  const auto put = [&](std::span<const std::byte> bytes) {
    checksum.add(bytes);
    write(bytes);
  };
  const std::string text = std::string(first_line) + to_json(header).dump() + "\n";
  put(std::as_bytes(std::span(text)));
  put(std::as_bytes(std::span(tile.positions)));
  put(tile.bricks);
  const std::uint64_t value = checksum.value();
  write(std::as_bytes(std::span(&value, 1)));
  return text.size();
}

StoredTile::StoredTile(const std::filesystem::path& file) {
  std::ifstream stream = open_tile(file);
  std::string line;
  if (!std::getline(stream, line) || line + "\n" != first_line) {
    refuse(file, "is no tile that this version reads");
  }
  std::string text(max_header_bytes, '\0');
  stream.getline(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream) {
    refuse(file, "is cut short");
  }
  text.resize(static_cast<std::size_t>(stream.gcount()) - 1);
  try {
    header_ = header_from(text);
  } catch (const Error& error) {
    refuse(file, error.what());
  }
  first_ = first_line.size() + text.size() + 1;
  stream.seekg(0);
  expect_whole(file, stream,
               first_ + header_.bricks * (sizeof(TileBrick) + brick_bytes(header_.options.method)));
  read_ = [file](std::uint64_t offset, std::span<std::byte> bytes) {
    std::ifstream part = open_tile(file);
    part.seekg(static_cast<std::streamoff>(offset));
    if (!part.read(reinterpret_cast<char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()))) {
      throw Error(ErrorCode::read_failed, file.string() + ": cannot be read");
    }
  };
}

StoredTile::StoredTile(const TileHeader& header, Read read, std::uint64_t first)
    : header_(header), read_(std::move(read)), first_(first) {}

std::vector<TileBrick> StoredTile::positions() const {
  std::vector<TileBrick> positions(header_.bricks);
  read_(first_, std::as_writable_bytes(std::span(positions)));
  const auto ordered = [](const TileBrick& a, const TileBrick& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  };
  if (!std::ranges::is_sorted(positions, ordered)) {
    throw Error(ErrorCode::scan_malformed,
                "tile " + std::to_string(header_.number) + ": its bricks are not in order");
  }
  const int side = TileLattice(header_.options).bricks_per_side();
  const auto is_outside = [side](const TileBrick& at) {
    return at.x >= side || at.y >= side || at.z >= side;
  };
  if (std::ranges::any_of(positions, is_outside)) {
    throw Error(ErrorCode::scan_malformed,
                "tile " + std::to_string(header_.number) + ": has a brick outside the tile");
  }
  return positions;
}

std::vector<std::byte> StoredTile::bricks(std::size_t first, std::size_t count) const {
  const std::size_t each = brick_bytes(header_.options.method);
  std::vector<std::byte> bytes(count * each);
  if (count > 0) {
    read_(first_ + header_.bricks * sizeof(TileBrick) + first * each, bytes);
  }
  return bytes;
}

namespace {

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
