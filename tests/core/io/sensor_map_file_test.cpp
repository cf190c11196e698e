#include <gtest/gtest.h>

#include <span>
#include <stdexcept>
#include <string>

#include "octurn/png.hpp"
#include "octurn/sensor_map.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

SensorMap small_map() {
  return {.width = 3,
          .height = 2,
          .near_inverse_depth = 1.625,
          .far_inverse_depth = 1.125,
          .near = {0, 0.00251F, -0.00252F, 0.001F, 0.3F, -0.3F},
          .far = {0.002F, 0, 0, 0, 0, -0.001F},
          .serial = "A00361",
          .made = "2026-11-23T01:02:03Z",
          .before = 0.0025,
          .after = 0.0005};
}

SensorMap decode(std::span<const std::byte> png) { return decode_sensor_map("map.png", png); }

TEST(SensorMapFile, ComesBackAsItWasWritten) {
  const SensorMap map = small_map();
  const SensorMap read = decode(encode_sensor_map(map));

  EXPECT_EQ(read.width, 3);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.near_inverse_depth, 1.625);
  EXPECT_EQ(read.far_inverse_depth, 1.125);
  ASSERT_EQ(read.near.size(), 6U);
  ASSERT_EQ(read.far.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(read.near[i], map.near[i], 0.50001e-5);  // half a step of the file
    EXPECT_NEAR(read.far[i], map.far[i], 0.50001e-5);
  }
  EXPECT_EQ(read.serial, "A00361");
  EXPECT_EQ(read.made, "2026-11-23T01:02:03Z");
  EXPECT_EQ(read.before, 0.0025);
  EXPECT_EQ(read.after, 0.0005);
}

TEST(SensorMapFile, RemembersTheOpticsThatItWasMadeWith) {
  SensorMap map = small_map();
  EXPECT_FALSE(decode(encode_sensor_map(map)).optics);
  map.optics = SensorOptics{.fx = 590.25, .fy = 589.5, .k1 = -0.0625, .depth_scale = 1.012};
  EXPECT_EQ(decode(encode_sensor_map(map)).optics, map.optics);
  EXPECT_FALSE(decode(encode_sensor_map(map)).on_for);
  map.on_for = 620;
  EXPECT_EQ(decode(encode_sensor_map(map)).on_for, 620);
}

TEST(SensorMapFile, HoldsAMapOfOneDistance) {
  SensorMap map = small_map();
  map.far.clear();
  const SensorMap read = decode(encode_sensor_map(map));
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.near.size(), 6U);
  EXPECT_TRUE(read.far.empty());
}

TEST(SensorMapFile, HoldsASerialOfAnyBytes) {
  SensorMap map = small_map();
  map.serial = "\xc3\xa4\xff\n\"";
  EXPECT_EQ(decode(encode_sensor_map(map)).serial, "\xc3\xa4\xef\xbf\xbd\n\"");
}

TEST(SensorMapFile, IsWrittenTheSameAgain) {
  const std::vector<std::byte> png = encode_sensor_map(small_map());
  EXPECT_EQ(encode_sensor_map(decode(png)), png);
}

TEST(SensorMapFile, IsRefusedWhenCutShortAnywhere) {
  const std::vector<std::byte> png = encode_sensor_map(small_map());
  for (std::size_t size = 0; size < png.size(); ++size) {
    EXPECT_EQ(code_thrown_by([&] { decode(std::span(png).first(size)); }), "scan-malformed")
        << size << " bytes";
  }
}

TEST(SensorMapFile, IsRefusedWithAnyByteChanged) {
  const std::vector<std::byte> png = encode_sensor_map(small_map());
  for (std::size_t at = 0; at < png.size(); ++at) {
    std::vector<std::byte> changed = png;
    changed[at] ^= std::byte{0x10};
    EXPECT_EQ(code_thrown_by([&] { decode(changed); }), "scan-malformed") << at;
  }
}

TEST(SensorMapFile, IsNoOtherPicture) {
  const DepthFrame frame{.width = 2, .height = 1, .depth = {1, 2}};
  const Error error = error_thrown_by([&] { decode(encode_depth_png(frame)); });
  EXPECT_EQ(error.code(), ErrorCode::scan_malformed);
  EXPECT_NE(std::string(error.what()).find("no map"), std::string::npos) << error.what();
}

TEST(SensorMapFile, IsWrittenToTheDiskAndRead) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "maps" / "A1.png";
  EXPECT_EQ(code_thrown_by([&] { read_sensor_map(file); }), "scan-malformed");
  write_sensor_map(file, small_map());
  EXPECT_EQ(read_sensor_map(file).serial, "A00361");
  std::filesystem::create_directory(folder.path() / "folder.png");
  EXPECT_EQ(code_thrown_by([&] { read_sensor_map(folder.path() / "folder.png"); }),
            "scan-malformed");
}

TEST(SensorMapFile, NeedsAnErrorForEachPixel) {
  SensorMap map = small_map();
  map.near.pop_back();
  EXPECT_THROW(encode_sensor_map(map), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
