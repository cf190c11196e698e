#include "scan/command_slot.hpp"

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

}  // namespace
}  // namespace octurn
