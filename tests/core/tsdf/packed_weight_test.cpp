#include <gtest/gtest.h>

#include "tsdf/tsdf_volume.hpp"

namespace octurn {
namespace {

TEST(PackedWeight, IsRoundedToAPartOfItself) {
  EXPECT_EQ(unpack(pack(0)), 0.0F);
  for (float weight = 1.0F / 4096; weight < 65536; weight *= 1.37F) {
    EXPECT_NEAR(unpack(pack(weight)), weight, weight / 4096);
  }
}

TEST(PackedWeight, StopsAtItsLargest) {
  EXPECT_NEAR(unpack(pack(65536)), 65536.0F, 32.0F);
  EXPECT_EQ(pack(1e9F), pack(65536));
}

}  // namespace
}  // namespace octurn
