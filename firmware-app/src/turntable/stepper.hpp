#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "turntable/pulse_train.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// Where a stepper has stood and how it got there, as far as the play of its gears needs to know.
struct Standing {
  int position = 0;
  bool play_taken_up = false;  ///< its last move was counter-clockwise, and it was held since
};

/// The positions to go to, one after the other, for a target: every target is reached
/// counter-clockwise, so that the gears always touch on the same side.
std::vector<int> way_to(int target, const Standing& from, int take_up_steps);

/// A platform turned by a stepper motor on an A4988.
///
/// Pulses are made by a thread of its own, with real-time priority where the system allows it. The
/// motor moves only by `move_to`, and is off (ENABLE high) before the first move, after `release`,
/// after a while without a move, and when this ends.
class Stepper final : public Turntable {
 public:
  /// In the order of `lines_of`.
  enum class Line { step, direction, enable };
  using SetLine = std::function<void(Line line, bool high)>;

  /// @param set_line  sets a line of the driver; called by one thread at a time. What it throws,
  ///                  `move_to` and `release` throw
  /// @param position  where it stands
  Stepper(const StepperSettings& settings, SetLine set_line, int position = 0);
  ~Stepper() override = default;
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(int position, std::stop_token stop) override;
  int position() const override { return position_; }
  int late_pulses() const override { return late().count; }
  void release() override;

  /// The late pulses of all moves.
  LatePulses late() const;

 private:
  struct Order {
    int target = 0;
    std::stop_token stop = {};
    bool done = false;
    bool arrived = false;
    std::exception_ptr failure = {};
  };

  void work(const std::stop_token& end);
  void carry_out(Order& order, std::unique_lock<std::mutex>& lock);
  bool turn_to(int position, const std::stop_token& stop);
  void hold(std::unique_lock<std::mutex>& lock, const std::stop_token& stop);
  void let_go();
  void report(const LatePulses& late, int pulses);

  StepperSettings settings_;
  Motion motion_;
  SetLine set_line_;
  std::atomic<int> position_;
  mutable std::mutex mutex_;  // guards what follows, and is held during a move
  std::condition_variable_any wake_;
  Order* order_ = nullptr;
  bool held_ = false;
  bool play_taken_up_ = false;
  LatePulses late_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
