#include "tiles/tile_files.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "octurn/tiles.hpp"
#include "support/room_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

ReconstructOptions room_options(Method method) {
  return {
      .method = method, .leaf_size = 0.032, .root_size = 1, .threshold = 0.02, .clip = everywhere};
}

/// A small room's model, written as one file for each tile.
class TileFiles : public testing::Test {
 protected:
  void make(const ReconstructOptions& options) {
    plan_ = plan_tiles(options, snapshots_);
    for (std::size_t i = 0; i < plan_.tiles.size(); ++i) {
      files_.push_back(folder_.path() / (std::to_string(i) + ".tile"));
      write_tile(options, plan_, i, snapshots_, files_.back());
    }
  }

  static std::string bytes(std::span<const Facet> facets) {
    const auto raw = std::as_bytes(facets);
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }

  std::string joined() const {
    std::string facets;
    join_tiles(files_, [&](std::span<const Facet> some) { facets += bytes(some); });
    return facets;
  }

  Error refusal() const {
    return error_thrown_by([&] { joined(); });
  }

  TemporaryFolder folder_ = {};
  SnapshotSource snapshots_ = room_scan(small_room(), 6);
  TilePlan plan_ = {};
  std::vector<fs::path> files_ = {};
};

TEST_F(TileFiles, JoinToTheSameBytesInAnyOrder) {
  for (const Method method : {Method::intersection, Method::solid}) {
    files_.clear();
    make(room_options(method));
    const auto reconstruction = make_tiled_reconstructor(room_options(method));
    reconstruction->add(snapshots_);
    std::string whole;
    reconstruction->surface(snapshots_, [&](std::span<const Facet> some) { whole += bytes(some); });

    std::ranges::reverse(files_);

    EXPECT_GT(whole.size(), 10'000U);
    EXPECT_TRUE(joined() == whole) << to_string(method);
  }
}

TEST_F(TileFiles, NameTheOneThatIsMissing) {
  make(room_options(Method::intersection));
  files_.erase(files_.begin() + 2);

  EXPECT_EQ(refusal().code(), ErrorCode::scan_missing);
  EXPECT_NE(std::string(refusal().what()).find("tile 2 of"), std::string::npos);
}

TEST_F(TileFiles, OfOtherSettingsOrScansAreRefused) {
  make(room_options(Method::intersection));
  ReconstructOptions other = room_options(Method::intersection);
  other.threshold = 0.03;
  write_tile(other, plan_tiles(other, snapshots_), 1, snapshots_, files_[1]);
  EXPECT_EQ(refusal().code(), ErrorCode::scan_malformed);
  EXPECT_NE(std::string(refusal().what()).find("threshold"), std::string::npos);

  const SnapshotSource others = room_scan(small_room(), 7);
  other = room_options(Method::intersection);
  write_tile(other, plan_tiles(other, others), 1, others, files_[1]);
  EXPECT_EQ(refusal().code(), ErrorCode::scan_malformed);

  fs::copy_file(files_[0], files_[1], fs::copy_options::overwrite_existing);
  EXPECT_EQ(refusal().code(), ErrorCode::scan_malformed);
  EXPECT_NE(std::string(refusal().what()).find("is tile 0"), std::string::npos);
}

TEST_F(TileFiles, CutShortOrDamagedAreRefused) {
  make(room_options(Method::intersection));
  const std::string whole = content_of(files_[0]);
  ASSERT_GT(whole.size(), 400U);
  for (std::size_t size = 0; size < whole.size(); size += size < 400 ? 1 : 97) {
    put(files_[0], std::string_view(whole).substr(0, size));
    ASSERT_EQ(refusal().code(), ErrorCode::scan_malformed) << size;
  }
  put(files_[0], whole + "x");
  EXPECT_EQ(refusal().code(), ErrorCode::scan_malformed);
  for (std::size_t at = 0; at < whole.size(); at += 61) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    put(files_[0], damaged);
    ASSERT_EQ(refusal().code(), ErrorCode::scan_malformed) << at;
  }
}

/// Changes a tile's last brick, and the file's checksum with it.
void change_last_brick(const fs::path& file, const std::function<void(TileBrick&)>& change) {
  std::string content = content_of(file);
  const std::size_t first = content.find('\n', content.find('\n') + 1) + 1;
  const std::size_t last = first + (StoredTile(file).header().bricks - 1) * sizeof(TileBrick);
  TileBrick brick;
  std::memcpy(&brick, &content[last], sizeof brick);
  change(brick);
  std::memcpy(&content[last], &brick, sizeof brick);
  std::uint64_t value = 0;
  content.resize(content.size() - sizeof value);
  Checksum checksum;
  checksum.add(std::as_bytes(std::span(content)));
  value = checksum.value();
  content.append(reinterpret_cast<const char*>(&value), sizeof value);
  put(file, content);
}

TEST_F(TileFiles, WithABrickOutsideTheTileAreRefused) {
  constexpr std::uint16_t outside = 4;  // a tile of 32 leaves has 4 bricks a side
  for (const Method method : {Method::intersection, Method::solid}) {
    files_.clear();
    make(room_options(method));
    const std::string whole = content_of(files_[0]);
    for (std::uint16_t TileBrick::*const axis : {&TileBrick::x, &TileBrick::y, &TileBrick::z}) {
      put(files_[0], whole);
      change_last_brick(files_[0], [&](TileBrick& brick) { brick.*axis = outside; });

      EXPECT_EQ(refusal().code(), ErrorCode::scan_malformed) << to_string(method);
      EXPECT_NE(std::string(refusal().what()).find("outside"), std::string::npos);
    }
  }
}

TEST_F(TileFiles, OfASnapshotThatHasChangedAreNotMade) {
  const ReconstructOptions options = room_options(Method::intersection);
  const TilePlan plan = plan_tiles(options, snapshots_);
  const SnapshotSource moved = {.count = snapshots_.count, .read = [&](std::size_t i) {
                                  Snapshot snapshot = snapshots_.read(i);
                                  snapshot.object_from_sensor.translation().x() += 0.001;
                                  return snapshot;
                                }};
  const fs::path file = folder_.path() / "moved.tile";

  EXPECT_EQ(code_thrown_by([&] { write_tile(options, plan, 0, moved, file); }), "scan-malformed");
  EXPECT_FALSE(fs::exists(file));
  EXPECT_EQ(code_thrown_by([&] { write_tile(options, plan, 99, snapshots_, file); }),
            "bad-settings");
}

TEST_F(TileFiles, APlanIsReadBackTheSameAndOnlyForItsSettings) {
  const ReconstructOptions options = room_options(Method::solid);
  const TilePlan plan = plan_tiles(options, snapshots_);
  const fs::path file = folder_.path() / "plan.json";
  write_plan(plan, options, file);

  const TilePlan read = read_plan(file, options);

  ASSERT_EQ(read.tiles.size(), plan.tiles.size());
  EXPECT_EQ(read.snapshots, plan.snapshots);
  for (std::size_t i = 0; i < plan.tiles.size(); ++i) {
    EXPECT_EQ(read.tiles[i].index, plan.tiles[i].index);
    EXPECT_EQ(read.tiles[i].snapshots, plan.tiles[i].snapshots);
    EXPECT_EQ(read.tiles[i].bytes, plan.tiles[i].bytes);
  }
  ReconstructOptions other = options;
  other.leaf_size /= 2;
  EXPECT_EQ(code_thrown_by([&] { read_plan(file, other); }), "scan-malformed");
  EXPECT_EQ(code_thrown_by([&] { read_plan(folder_.path() / "none", options); }), "scan-missing");
  put(file, "{}");
  EXPECT_EQ(code_thrown_by([&] { read_plan(file, options); }), "scan-malformed");
}

}  // namespace
}  // namespace octurn
