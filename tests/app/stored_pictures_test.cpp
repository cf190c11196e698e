// A stop's pictures on the disk: grey, except for the dark picture of a colour camera.

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "capture/take_pictures.hpp"
#include "store/stored_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

constexpr int width = 4;
constexpr int height = 3;

Scan empty_scan() {
  return {.sensor_name = "camera of a test",
          .intrinsics = {.width = width, .height = height, .fx = 4, .fy = 4, .cx = 2, .cy = 1.5},
          .laser = LaserCamera{.lasers = {{.name = "left"}}},
          .clip = {.min = {-0.1, -0.1, 0}, .max = {0.1, 0.1, 0.2}}};
}

Picture grey(std::uint8_t level) {
  return {.width = width,
          .height = height,
          .samples = std::vector<std::uint8_t>(width * height, level)};
}

class StoredPictures : public ::testing::Test {
 protected:
  void store(const std::vector<Rgb>& colours) {
    PictureWriter writer(folder_.path(), picture_files(0, *scan_.laser));
    writer.add(grey(20), colours);
    writer.add(grey(90), {});
    writer.finish();
    store_stop(folder_.path(), scan_, 0.5);
  }

  std::string stored(const std::string& name) const {
    return content_of(folder_.path() / "snapshots" / name);
  }

  TemporaryFolder folder_ = {};
  Scan scan_ = empty_scan();
};

std::string grey_file(std::uint8_t level) {
  const auto png = encode_grey_png(width, height, grey(level).samples);
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

TEST_F(StoredPictures, AreGreyOfACameraWithoutColours) {
  store({});

  EXPECT_EQ(stored("000-dark.png"), grey_file(20));
  EXPECT_EQ(stored("000-left.png"), grey_file(90));
  EXPECT_FALSE(has_colours(folder_.path(), scan_));
}

TEST_F(StoredPictures, HaveTheColoursOfTheDarkOne) {
  std::vector<Rgb> colours(width * height, Rgb{20, 20, 20});
  colours[5] = {60, 3, 1};
  store(colours);

  const std::string png = stored("000-dark.png");
  const auto bytes = std::as_bytes(std::span(png));
  EXPECT_EQ(decode_rgb_png("dark", bytes, width, height).pixels, colours);
  EXPECT_EQ(stored("000-left.png"), grey_file(90));
  EXPECT_TRUE(has_colours(folder_.path(), scan_));
  EXPECT_TRUE(has_colours(folder_.path(), read_scan(folder_.path())));
}

// For example a monochrome camera that sends YUYV.
TEST_F(StoredPictures, AreGreyWhereACameraSendsNoColourAtAll) {
  store(std::vector<Rgb>(width * height, Rgb{20, 20, 20}));

  EXPECT_EQ(stored("000-dark.png"), grey_file(20));
  EXPECT_FALSE(has_colours(folder_.path(), scan_));
}

TEST_F(StoredPictures, AreNoneWhereTheFileIsGone) {
  store(std::vector<Rgb>(width * height, Rgb{1, 2, 3}));
  std::filesystem::remove(folder_.path() / "snapshots" / "000-dark.png");

  EXPECT_FALSE(has_colours(folder_.path(), scan_));
  EXPECT_FALSE(has_colours(folder_.path(), Scan{}));
}

}  // namespace
}  // namespace octurn
