#include "turntable/stepper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "capture/plan.hpp"
#include "octurn/error.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

/// The driver's line changes as letters: E and e for ENABLE high and low, D and d for DIR, S and s
/// for STEP.
class LineChanges {
 public:
  void set(Stepper::Line line, bool high) {
    constexpr std::string_view low_letters = "sde";
    constexpr std::string_view high_letters = "SDE";
    const std::lock_guard lock(mutex_);
    changes_ += (high ? high_letters : low_letters)[static_cast<std::size_t>(line)];
    changed_.notify_all();
  }

  std::string changes() const {
    const std::lock_guard lock(mutex_);
    return changes_;
  }

  int pulses() const {
    const std::string all = changes();
    return static_cast<int>(std::ranges::count(all, 'S'));
  }

  /// Waits until the changes end with `end`.
  void wait_for_end(std::string_view end) const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return changes_.ends_with(end); });
  }

 private:
  mutable std::mutex mutex_;  // guards changes_
  mutable std::condition_variable changed_;
  std::string changes_ = {};
};

const StepperSettings fast = {.speed_deg_per_second = 2250,
                              .start_speed_deg_per_second = 2250,
                              .acceleration_deg_per_second2 = 1e6,
                              .settle_time = 0ms};

class StepperTest : public ::testing::Test {
 protected:
  Stepper::SetLine recorder() {
    return [this](Stepper::Line line, bool high) { recording_.set(line, high); };
  }

  LineChanges recording_;
};

TEST_F(StepperTest, SwitchesOnChoosesItsDirectionAndOnlyThenSteps) {
  Stepper stepper(fast, recorder());
  EXPECT_TRUE(stepper.move_to(3, {}));
  EXPECT_EQ(recording_.changes(), "eDSsSsSs");
  EXPECT_EQ(stepper.position(), 3);

  EXPECT_TRUE(stepper.move_to(1, {}));
  EXPECT_EQ(recording_.changes(), "eDSsSsSsdSsSs");
  EXPECT_EQ(stepper.position(), 1);
}

TEST_F(StepperTest, TurnsTheOtherWayRoundIfItIsReversed) {
  StepperSettings settings = fast;
  settings.reversed = true;
  Stepper stepper(settings, recorder());
  EXPECT_TRUE(stepper.move_to(1, {}));
  EXPECT_EQ(recording_.changes(), "edSs");
}

TEST_F(StepperTest, MakesATurnOfExactly800Steps) {
  Stepper stepper(fast, recorder());
  for (const int stops : {7, 36}) {
    for (const std::int64_t position :
         stop_positions(stepper.position(), stepper.steps_per_turn(), stops)) {
      ASSERT_TRUE(stepper.move_to(position, {}));
    }
    ASSERT_TRUE(stepper.move_to(stop_positions(stepper.position(), 800, 1)[0], {}));
    EXPECT_EQ(stepper.position() % 800, 0);
    EXPECT_EQ(recording_.pulses(), stepper.position());
  }
  EXPECT_EQ(stepper.position(), 1600);
}

TEST_F(StepperTest, CountsOnBeyond32Bits) {
  constexpr std::int64_t begin = std::numeric_limits<std::int32_t>::max();
  Stepper stepper(fast, recorder(), begin);
  EXPECT_TRUE(stepper.move_to(begin + 3, {}));
  EXPECT_EQ(stepper.position(), begin + 3);
  EXPECT_EQ(recording_.changes(), "eDSsSsSs");
}

TEST_F(StepperTest, GoesOnFromWhereThePlatformStands) {
  Stepper stepper(fast, recorder(), 600);
  EXPECT_EQ(stepper.position(), 600);
  EXPECT_TRUE(stepper.move_to(603, {}));
  EXPECT_EQ(recording_.changes(), "eDSsSsSs");
}

TEST_F(StepperTest, NeverDoesAnythingByItself) {
  {
    Stepper stepper(fast, recorder());
    stepper.release();
  }
  EXPECT_EQ(recording_.changes(), "");
}

TEST_F(StepperTest, DoesNotEvenSwitchOnForWhatIsStoppedAlready) {
  std::stop_source stop;
  stop.request_stop();
  Stepper stepper(fast, recorder());
  EXPECT_FALSE(stepper.move_to(1, stop.get_token()));
  EXPECT_EQ(recording_.changes(), "");
}

TEST_F(StepperTest, LetsGoWhenAsked) {
  Stepper stepper(fast, recorder());
  stepper.move_to(1, {});
  stepper.release();
  stepper.release();
  EXPECT_EQ(recording_.changes(), "eDSsE");
  stepper.move_to(2, {});
  EXPECT_EQ(recording_.changes(), "eDSsEeDSs");
}

TEST_F(StepperTest, LetsGoAtItsEnd) {
  Stepper(fast, recorder()).move_to(1, {});
  EXPECT_EQ(recording_.changes(), "eDSsE");
}

TEST_F(StepperTest, LetsGoAfterAWhile) {
  StepperSettings settings = fast;
  settings.idle_release = 1ms;
  Stepper stepper(settings, recorder());
  stepper.move_to(1, {});
  recording_.wait_for_end("E");
  EXPECT_EQ(recording_.changes(), "eDSsE");
}

TEST_F(StepperTest, StopsBeforeTheNextStep) {
  std::stop_source stop;
  Stepper stepper(fast, [&](Stepper::Line line, bool high) {
    recording_.set(line, high);
    if (recording_.pulses() == 40) {
      stop.request_stop();
    }
  });
  EXPECT_FALSE(stepper.move_to(800, stop.get_token()));
  EXPECT_EQ(stepper.position(), 40);
  EXPECT_EQ(recording_.pulses(), 40);
  EXPECT_EQ(recording_.changes().back(), 's');

  EXPECT_FALSE(stepper.move_to(800, stop.get_token()));  // the stop request still holds
  EXPECT_EQ(recording_.pulses(), 40);
  EXPECT_TRUE(stepper.move_to(41, {}));
  EXPECT_EQ(recording_.pulses(), 41);
}

TEST_F(StepperTest, StopsWhileItSettles) {
  StepperSettings settings = fast;
  settings.settle_time = 1h;
  std::stop_source stop;
  Stepper stepper(settings, recorder());
  std::jthread stopper([&] {
    recording_.wait_for_end("Ss");
    stop.request_stop();
  });
  EXPECT_FALSE(stepper.move_to(1, stop.get_token()));
  EXPECT_EQ(stepper.position(), 1);
}

TEST_F(StepperTest, ReturnsOnlyWhenItHasSettled) {
  StepperSettings settings = fast;
  settings.settle_time = 150ms;
  Stepper stepper(settings, recorder());
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(stepper.move_to(1, {}));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 150ms);
}

TEST_F(StepperTest, TakesUpTheBacklashOfItsGears) {
  StepperSettings settings = fast;
  settings.take_up_steps = 2;
  Stepper stepper(settings, recorder());
  stepper.move_to(0, {});
  EXPECT_EQ(recording_.changes(), "edSsSsDSsSs");  // the play's side is unknown, so it is taken up
  stepper.move_to(1, {});
  EXPECT_EQ(recording_.changes(), "edSsSsDSsSsDSs");  // same direction: no play to take up
  stepper.move_to(0, {});
  EXPECT_EQ(recording_.changes(), "edSsSsDSsSsDSsdSsSsSsDSsSs");
  EXPECT_EQ(stepper.position(), 0);
}

TEST(PlanMoves, ReachesEveryTargetCounterClockwise) {
  using Moves = std::vector<std::int64_t>;
  const BacklashState taken_up = {.position = 100, .backlash_taken_up = true};
  const BacklashState loose = {.position = 100, .backlash_taken_up = false};
  EXPECT_EQ(plan_moves(120, taken_up, 8), Moves{120});
  EXPECT_EQ(plan_moves(100, taken_up, 8), Moves{100});
  EXPECT_EQ(plan_moves(80, taken_up, 8), (Moves{72, 80}));
  EXPECT_EQ(plan_moves(120, loose, 8), (Moves{92, 120}));
  EXPECT_EQ(plan_moves(80, loose, 0), Moves{80});
}

TEST_F(StepperTest, TellsOfALineThatFailsAndGoesOnAfterwards) {
  bool broken = true;
  Stepper stepper(fast, [&](Stepper::Line line, bool high) {
    if (broken && recording_.pulses() == 5) {
      throw Error(ErrorCode::turntable_failed, "line GPIO17 cannot be set");
    }
    recording_.set(line, high);
  });
  EXPECT_EQ(code_thrown_by([&] { stepper.move_to(10, {}); }), "turntable-failed");
  EXPECT_EQ(stepper.position(), 5);
  EXPECT_EQ(code_thrown_by([&] { stepper.release(); }), "turntable-failed");

  broken = false;
  EXPECT_TRUE(stepper.move_to(10, {}));
  EXPECT_EQ(recording_.pulses(), 10);
}

TEST_F(StepperTest, CountsLatePulses) {
  // The sleep stands for the delay of a busy system at each rising edge.
  Stepper stepper(fast, [&](Stepper::Line line, bool high) {
    if (line == Stepper::Line::step && high) {
      std::this_thread::sleep_for(2ms);
    }
    recording_.set(line, high);
  });
  stepper.move_to(10, {});
  EXPECT_EQ(stepper.late().count, 10);
  EXPECT_EQ(stepper.late_pulses(), 10);
  EXPECT_GE(stepper.late().longest, 2ms);
}

}  // namespace
}  // namespace octurn
