#include "calibration/lens_files.hpp"

#include <gtest/gtest.h>

#include <string>

#include "octurn/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

LensReport some_report() {
  LensReport report{.accepted = true, .views = 14, .corners = 1800, .rms = 0.07};
  report.lens = {
      .intrinsics =
          {.width = 820, .height = 616, .fx = 690.25, .fy = 689.5, .cx = 414.125, .cy = 303.75},
      .k1 = -0.0625,
      .k2 = 0.03125};
  report.sigma = {
      .intrinsics = {.fx = 0.125, .fy = 0.125, .cx = 0.25, .cy = 0.25}, .k1 = 0.001, .k2 = 0.002};
  return report;
}

CameraLens told() { return told_lens(LaserSettings{}); }

TEST(LensFiles, KeepWhatABoardToldOfACamera) {
  const TemporaryFolder data;
  keep_lens(data.path(), "usb/0c45:6366", some_report());

  const auto kept = find_lens(data.path(), "usb/0c45:6366");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->serial, "usb/0c45:6366");
  EXPECT_EQ(kept->lens.intrinsics.fx, 690.25);
  EXPECT_EQ(kept->lens.intrinsics.cy, 303.75);
  EXPECT_EQ(kept->lens.k2, 0.03125);
  EXPECT_EQ(kept->sigma.intrinsics.cx, 0.25);
  EXPECT_EQ(kept->rms, 0.07);
  EXPECT_EQ(kept->views, 14);
  EXPECT_EQ(kept->made.size(), 20U);  // 2026-11-26T05:00:00Z
  EXPECT_EQ(lens_path("/data", "usb/0c45:6366"), "/data/lenses/usb_0c45_6366.json");
}

TEST(LensFiles, GoWithTheirCameraAndItsPictureSize) {
  const TemporaryFolder data;
  keep_lens(data.path(), "A", some_report());

  EXPECT_EQ(lens_in_force(data.path(), "A", told()).k1, -0.0625);
  EXPECT_EQ(lens_in_force(data.path(), "A", told()).intrinsics.fx, 690.25);
  EXPECT_EQ(lens_in_force(data.path(), "B", told()).intrinsics.fx, told().intrinsics.fx);
  EXPECT_EQ(lens_in_force(data.path(), "", told()).intrinsics.fx, told().intrinsics.fx);
  CameraLens larger = told();
  larger.intrinsics.width = 1640;
  EXPECT_EQ(lens_in_force(data.path(), "A", larger).k1, 0);
}

TEST(LensFiles, AreRemoved) {
  const TemporaryFolder data;
  keep_lens(data.path(), "A", some_report());
  remove_lens(data.path(), "A");
  EXPECT_FALSE(find_lens(data.path(), "A"));
}

TEST(LensFiles, ThatAreDamagedAreNamed) {
  const TemporaryFolder data;
  keep_lens(data.path(), "A", some_report());
  const std::string whole = content_of(lens_path(data.path(), "A"));
  for (std::size_t length = 0; length + 2 < whole.size(); ++length) {
    put(lens_path(data.path(), "A"), whole.substr(0, length));
    const Error error = error_thrown_by([&] { find_lens(data.path(), "A"); });
    EXPECT_EQ(error.code(), ErrorCode::scan_malformed) << length;
    EXPECT_NE(std::string(error.what()).find("A.json"), std::string::npos) << error.what();
  }
  put(lens_path(data.path(), "A"), R"({"format": "octurn-lens", "version": 2})");
  EXPECT_EQ(error_thrown_by([&] { find_lens(data.path(), "A"); }).code(),
            ErrorCode::scan_malformed);
}

}  // namespace
}  // namespace octurn
