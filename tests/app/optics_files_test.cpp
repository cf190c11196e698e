#include "calibration/optics_files.hpp"

#include <gtest/gtest.h>

#include <string>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

OpticsRecord record_of(double fx) {
  return {.optics = {.value = {.fx = fx, .fy = 589.5, .cx = 331.25, .k1 = -0.0625},
                     .sigma = {.fx = 0.5, .fy = 0.5, .cx = 0.75, .cy = 0.75, .k1 = 0.0125}},
          .origin = OpticsOrigin::scan,
          .at = "2026-11-28T08:00:00Z"};
}

class OpticsFiles : public ::testing::Test {
 protected:
  TemporaryFolder data_;
};

TEST_F(OpticsFiles, KeepOpticsToTheLastBit) {
  EXPECT_TRUE(read_optics(data_.path(), "usb/1").empty());
  EXPECT_FALSE(optics_in_force(data_.path(), "usb/1"));
  const OpticsRecord record = record_of(590 + 1e-12);
  keep_optics(data_.path(), "usb/1", record);

  const auto kept = read_optics(data_.path(), "usb/1");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept.front().optics.value, record.optics.value);
  EXPECT_EQ(kept.front().optics.sigma, record.optics.sigma);
  EXPECT_EQ(kept.front().origin, OpticsOrigin::scan);
  EXPECT_EQ(kept.front().at, "2026-11-28T08:00:00Z");
  EXPECT_EQ(optics_in_force(data_.path(), "usb/1"), record.optics.value);
  EXPECT_EQ(optics_path("/data", "usb/1"), "/data/optics/usb_1.json");
}

TEST_F(OpticsFiles, AreOfOneSensor) {
  keep_optics(data_.path(), "A", record_of(590));
  EXPECT_FALSE(optics_in_force(data_.path(), "B"));
  EXPECT_FALSE(optics_in_force(data_.path(), ""));
}

TEST_F(OpticsFiles, RememberTenBeforeThoseInForce) {
  for (int i = 0; i < 15; ++i) {
    keep_optics(data_.path(), "A", record_of(580 + i));
  }
  const auto kept = read_optics(data_.path(), "A");
  ASSERT_EQ(kept.size(), max_optics_history + 1);
  EXPECT_EQ(kept.front().optics.value.fx, 594);
  EXPECT_EQ(kept.back().optics.value.fx, 584);
}

TEST_F(OpticsFiles, RememberABoardHoweverManyFollow) {
  OpticsRecord by_board = record_of(590);
  by_board.origin = OpticsOrigin::board;
  keep_optics(data_.path(), "A", by_board);
  for (int i = 0; i < 15; ++i) {
    keep_optics(data_.path(), "A", record_of(580 + i));
  }
  const auto kept = read_optics(data_.path(), "A");
  ASSERT_EQ(kept.size(), max_optics_history + 1);
  EXPECT_EQ(kept.back().origin, OpticsOrigin::board);
  EXPECT_EQ(kept[max_optics_history - 1].optics.value.fx, 585);
}

TEST_F(OpticsFiles, AreTakenBackOneAfterTheOther) {
  keep_optics(data_.path(), "A", record_of(581));
  keep_optics(data_.path(), "A", record_of(582));
  undo_optics(data_.path(), "A");
  EXPECT_EQ(optics_in_force(data_.path(), "A")->fx, 581);
  undo_optics(data_.path(), "A");
  EXPECT_FALSE(optics_in_force(data_.path(), "A"));
  EXPECT_EQ(code_thrown_by([&] { undo_optics(data_.path(), "A"); }), "not-found");
}

TEST_F(OpticsFiles, CountAsNoneIfTheyAreDamaged) {
  keep_optics(data_.path(), "A", record_of(581));
  const std::string whole = content_of(optics_path(data_.path(), "A"));
  for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
    put(optics_path(data_.path(), "A"), whole.substr(0, length));
    EXPECT_EQ(code_thrown_by([&] { read_optics(data_.path(), "A"); }), "platform-malformed");
    EXPECT_FALSE(optics_in_force(data_.path(), "A"));
  }
  keep_optics(data_.path(), "A", record_of(582));
  EXPECT_EQ(read_optics(data_.path(), "A").size(), 1U);
}

}  // namespace
}  // namespace octurn
