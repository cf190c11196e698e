#include "run/command_slot.hpp"

#include <gtest/gtest.h>

#include <future>

#include "support/patience.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

bool offer_model(CommandSlot& slot, std::chrono::milliseconds wait) {
  return slot.offer_rebuild({}, {}, wait);
}

TEST(CommandSlot, HasAModelWaitForTheEndOfTheOneBefore) {
  CommandSlot slot;
  ASSERT_TRUE(offer_model(slot, 0ms));
  ASSERT_TRUE(slot.take(patience));
  EXPECT_FALSE(offer_model(slot, 1ms)) << "it has not ended";
  auto second = std::async(std::launch::async, [&] { return offer_model(slot, patience); });
  slot.finish();
  EXPECT_TRUE(second.get());
}

TEST(CommandSlot, HasNoModelWaitForABuildOrAScan) {
  for (const bool is_scan : {false, true}) {
    CommandSlot slot;
    ASSERT_TRUE(is_scan ? slot.offer_scan(ScanCommand{}) : slot.offer_build({}));
    EXPECT_FALSE(offer_model(slot, patience)) << "it is refused at once";
    ASSERT_TRUE(slot.take(patience));
    EXPECT_FALSE(offer_model(slot, patience));
  }
}

TEST(CommandSlot, EndsABuildForAScanAndTakesThePlaceOfOneThatWaits) {
  CommandSlot slot;
  ASSERT_TRUE(slot.offer_build({}));
  const auto build = slot.take(patience);
  ASSERT_TRUE(build);
  EXPECT_FALSE(slot.offer_build({})) << "one at a time";
  EXPECT_TRUE(slot.offer_scan(ScanCommand{}));
  EXPECT_TRUE(build->stop.stop_requested());
  slot.finish();
  const auto scan = slot.take(patience);
  ASSERT_TRUE(scan);
  EXPECT_TRUE(std::holds_alternative<ScanCommand>(scan->command));
  slot.finish();

  ASSERT_TRUE(slot.offer_build({}));
  ASSERT_TRUE(slot.offer_scan(ScanCommand{}));
  const auto next = slot.take(patience);
  ASSERT_TRUE(next);
  EXPECT_TRUE(std::holds_alternative<ScanCommand>(next->command));
}

TEST(CommandSlot, ForgetsABuildThatWaitsAndStopsOneThatGoesOn) {
  CommandSlot slot;
  ASSERT_TRUE(slot.offer_build({}));
  EXPECT_TRUE(slot.stop_build());
  EXPECT_FALSE(slot.is_occupied());
  ASSERT_TRUE(slot.offer_build({}));
  const auto build = slot.take(patience);
  ASSERT_TRUE(build);
  EXPECT_FALSE(slot.stop_build());
  EXPECT_TRUE(build->stop.stop_requested());
}

TEST(CommandSlot, SaysWhichScanOrBuildWaitsOrRuns) {
  CommandSlot slot;
  ASSERT_TRUE(slot.offer_build({.run = {.scan = "a", .number = 2}}));
  for (const bool runs : {false, true}) {
    ASSERT_EQ(runs, runs && slot.take(patience));
    EXPECT_TRUE(slot.has_build("a"));
    EXPECT_TRUE(slot.has_build("a", 2));
    EXPECT_FALSE(slot.has_build("a", 1));
    EXPECT_FALSE(slot.has_build("b"));
    EXPECT_FALSE(slot.has_scan("a"));
    EXPECT_TRUE(slot.is_busy());
  }
  ASSERT_TRUE(slot.offer_scan(ScanCommand{.job = {.id = "b"}}));
  EXPECT_TRUE(slot.has_build("a")) << "until it has stopped";
  slot.finish();
  for (const bool runs : {false, true}) {
    ASSERT_EQ(runs, runs && slot.take(patience));
    EXPECT_TRUE(slot.has_scan("b"));
    EXPECT_FALSE(slot.has_scan("a"));
    EXPECT_FALSE(slot.has_measurement());
    EXPECT_FALSE(slot.has_build("a"));
  }
  slot.finish();
  EXPECT_FALSE(slot.has_scan("b"));
  EXPECT_FALSE(slot.is_busy());
}

TEST(CommandSlot, EndsALensCalibrationEarlyOnceItHasAView) {
  CommandSlot slot;
  ASSERT_TRUE(slot.offer_scan(LensCommand{}));
  EXPECT_TRUE(slot.has_measurement());
  EXPECT_FALSE(slot.solve_lens()) << "it waits";
  const auto lens = slot.take(patience);
  ASSERT_TRUE(lens);
  EXPECT_TRUE(slot.has_measurement());
  EXPECT_FALSE(slot.solve_lens()) << "no view yet";
  EXPECT_FALSE(lens->stop.stop_requested());
  slot.report_lens_view();
  EXPECT_TRUE(slot.solve_lens());
  EXPECT_TRUE(lens->stop.stop_requested());
  EXPECT_EQ(slot.scan_stop(), ScanStop::pause);
  slot.finish();
  EXPECT_FALSE(slot.solve_lens());
  EXPECT_FALSE(slot.has_measurement());
}

}  // namespace
}  // namespace octurn
