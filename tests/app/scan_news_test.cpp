#include <gtest/gtest.h>

#include "http/scan_view.hpp"

namespace octurn {
namespace {

using Events = std::vector<std::pair<std::string, std::string>>;

Events events_of(const ScanStates& before, const ScanStates& now, const std::string& newest) {
  Events events;
  for (const ScanEvent& event : changes(before, now, newest)) {
    events.emplace_back(event.event, event.id);
  }
  return events;
}

TEST(ScanNews, AreWhatHasBecomeOfTheScans) {
  const ScanStates before{{"1", JobState::running}, {"2", JobState::paused}};
  const ScanStates now{
      {"1", JobState::finished}, {"2", JobState::running}, {"3", JobState::running}};
  EXPECT_EQ(events_of(before, now, "2"),
            (Events{{"scan-finished", "1"}, {"scan-started", "2"}, {"scan-started", "3"}}));
}

TEST(ScanNews, AreNotForUnchangedOrRemovedScans) {
  EXPECT_TRUE(events_of({{"1", JobState::failed}, {"2", JobState::finished}},
                        {{"1", JobState::failed}}, "2")
                  .empty());
}

TEST(ScanNews, AreNotWhatComesOutOfTheBin) {
  EXPECT_TRUE(
      events_of({{"2", JobState::finished}},
                {{"1", JobState::finished}, {"2", JobState::finished}, {"3", JobState::finished}},
                "3")
          .empty());
}

TEST(ScanNews, AreTheEndOfAScanThatNobodySawBegin) {
  EXPECT_EQ(events_of({}, {{"1", JobState::failed}}, ""), (Events{{"scan-failed", "1"}}));
}

}  // namespace
}  // namespace octurn
