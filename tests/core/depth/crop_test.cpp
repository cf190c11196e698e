#include "depth/crop.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace octurn {
namespace {

const Box held{.min = {-0.02, -0.03, 0.5}, .max = {0.03, 0.02, 0.6}};  // metres, sensor's frame

/// A snapshot whose samples hold their own index.
Snapshot numbered() {
  Snapshot snapshot;
  snapshot.frame = {.width = snapshot.intrinsics.width, .height = snapshot.intrinsics.height};
  for (int i = 0; i < snapshot.frame.width * snapshot.frame.height; ++i) {
    snapshot.frame.depth.push_back(static_cast<std::uint16_t>(i % 65521));
  }
  return snapshot;
}

Snapshot moved(double x, double z) {
  Snapshot snapshot = numbered();
  snapshot.object_from_sensor.translation() = Eigen::Vector3d(x, 0, z);
  return snapshot;
}

TEST(Crop, KeepsWhatSeesTheBoxWhereItWas) {
  const Snapshot whole = numbered();
  const Snapshot part = crop(whole, held);
  const Intrinsics& intrinsics = part.intrinsics;
  EXPECT_LT(intrinsics.width, 100);
  EXPECT_LT(intrinsics.height, 100);
  ASSERT_EQ(part.frame.width, intrinsics.width);
  ASSERT_EQ(part.frame.height, intrinsics.height);
  const double u0 = whole.intrinsics.cx - intrinsics.cx;
  const double v0 = whole.intrinsics.cy - intrinsics.cy;
  for (int v = 0; v < intrinsics.height; ++v) {
    for (int u = 0; u < intrinsics.width; ++u) {
      const auto at =
          static_cast<std::size_t>((v + static_cast<int>(v0)) * 640 + u + static_cast<int>(u0));
      ASSERT_EQ(part.frame.depth[static_cast<std::size_t>(v * intrinsics.width + u)],
                whole.frame.depth[at]);
    }
  }
  for (const double x : {held.min.x(), held.max.x()}) {
    for (const double y : {held.min.y(), held.max.y()}) {
      const double u = x / held.min.z() * intrinsics.fx + intrinsics.cx;
      const double v = y / held.min.z() * intrinsics.fy + intrinsics.cy;
      EXPECT_TRUE(u > 3 && u < intrinsics.width - 3) << u;
      EXPECT_TRUE(v > 3 && v < intrinsics.height - 3) << v;
    }
  }
}

TEST(Crop, EndsAtTheImagesEdges) {
  const Snapshot part = crop(moved(0.27, 0), held);
  EXPECT_EQ(part.intrinsics.cx, 320);
  EXPECT_LT(part.intrinsics.width, 100);
}

TEST(Crop, KeepsAllOfASnapshotNearTheBoxOrBesideIt) {
  EXPECT_EQ(crop(moved(0, 0.48), held).intrinsics, Intrinsics{});
  EXPECT_EQ(crop(moved(0, 2), held).intrinsics, Intrinsics{});
  EXPECT_EQ(crop(moved(9, 0), held).intrinsics, Intrinsics{});
}

TEST(Crop, RefusesAFrameOfAnotherSize) {
  Snapshot snapshot = numbered();
  snapshot.frame.depth.pop_back();
  EXPECT_THROW(crop(snapshot, held), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
