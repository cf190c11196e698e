#include <gtest/gtest.h>

#include <vector>

#include "octurn/tiles.hpp"
#include "support/room_scan.hpp"

namespace octurn {
namespace {

TEST(CompareViews, AgreesOnARoom) {
  const std::vector<Snapshot> views = spread_views(room_scan(small_room(), 30));
  ASSERT_EQ(views.size(), 24U);

  const ViewAgreement found = compare_views(views);

  EXPECT_GT(found.compared, 10'000U);
  EXPECT_GT(found.share(), 0.95);
  EXPECT_TRUE(found.is_credible());
  EXPECT_LT(found.gap, 0.003) << "metres: the grid's pixels are some millimetres apart";
}

TEST(CompareViews, SeesAWrongDepthUnitAndWrongPoses) {
  const std::vector<Snapshot> views = spread_views(room_scan(small_room(), 12));

  std::vector<Snapshot> five_times_too_far = views;
  std::vector<Snapshot> inverted = views;
  for (std::size_t i = 0; i < views.size(); ++i) {
    five_times_too_far[i].intrinsics.depth_unit *= 5;
    inverted[i].object_from_sensor = views[i].object_from_sensor.inverse();
  }

  EXPECT_LT(compare_views(five_times_too_far).net(), compare_views(views).net() / 2);
  const ViewAgreement wrong = compare_views(inverted);
  EXPECT_LT(wrong.net(), compare_views(views).net() / 2)
      << wrong.agreeing << ' ' << wrong.contradicted;
  EXPECT_FALSE(wrong.is_credible()) << wrong.agreeing << ' ' << wrong.contradicted;
}

TEST(CompareViews, FindsNothingInOneView) {
  const ViewAgreement found = compare_views(spread_views(room_scan(small_room(), 1)));
  EXPECT_EQ(found.compared, 0U);
  EXPECT_EQ(found.share(), 1);
  EXPECT_FALSE(found.is_credible());
}

}  // namespace
}  // namespace octurn
