#include <gtest/gtest.h>

#include "http/event_feed.hpp"

namespace octurn {
namespace {

TEST(EventBoard, TellsTheNewestOfEachKind) {
  EventBoard board("run");
  board.publish({{"status", "1"}, {"scans", "2"}});
  board.publish({{"status", "3"}, {"scans", "2"}});
  std::uint64_t seen = 0;
  EXPECT_EQ(board.events_after(seen),
            "id: run-2\nevent: scans\ndata: 2\n\nid: run-3\nevent: status\ndata: 3\n\n");
  EXPECT_EQ(board.events_after(seen), "");
}

TEST(EventBoard, LeavesOutWhatAClientHasHad) {
  EventBoard board("run");
  board.publish({{"status", "1"}, {"scans", "2"}});
  std::uint64_t seen = board.number("run-1");
  EXPECT_EQ(board.events_after(seen), "id: run-2\nevent: scans\ndata: 2\n\n");
}

TEST(EventBoard, TellsAllToAClientOfAnotherRunOrOfNone) {
  EventBoard board("run");
  board.publish({{"status", "1"}});
  for (const char* const id : {"", "other-1", "run", "run-", "run-2", "run-x", "run-1x", "run--1",
                               "run-99999999999999999999"}) {
    EXPECT_EQ(board.number(id), 0U) << id;
  }
  EXPECT_EQ(board.number("run-1"), 1U);
}

}  // namespace
}  // namespace octurn
