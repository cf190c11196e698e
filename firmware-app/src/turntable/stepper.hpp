#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "failure.hpp"
#include "turntable/motion.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A stepper's position, and whether its gears touch on the side of counter-clockwise moves.
struct BacklashState {
  std::int64_t position = 0;
  bool backlash_taken_up =
      false;  ///< the last move was counter-clockwise, and the motor has been on since
};

/// Returns the positions to visit on the way to a target, in order. Every target is approached
/// counter-clockwise, so that the gears always touch on the same side.
/// @param take_up_steps  more than the gears' backlash, microsteps; 0: they have none
std::vector<std::int64_t> plan_moves(std::int64_t target, const BacklashState& from,
                                     int take_up_steps);

/// A platform turned by a stepper motor on an A4988.
///
/// A thread of its own makes the pulses, with real-time priority where the system allows it. The
/// motor moves only in `move_to`. It is off (ENABLE high) before the first move, after `release`,
/// after `idle_release` without a move, and at the end of this object.
class Stepper final : public Turntable {
 public:
  /// In the order of `to_gpio_lines`.
  enum class Line { step, direction, enable };
  using SetLine = std::function<void(Line line, bool high)>;

  /// @param set_line  sets a line of the driver; called by one thread at a time. Its exceptions
  ///                  leave through `move_to` and `release`
  /// @param position  the initial one, microsteps
  Stepper(const StepperSettings& settings, SetLine set_line, std::int64_t position = 0);
  ~Stepper() override = default;
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(std::int64_t position, std::stop_token stop) override;
  void set_pace(double pace) override;
  std::int64_t position() const override { return position_; }
  int late_pulses() const override { return late().count; }
  bool may_have_lost_steps() const override { return may_have_lost_steps_; }
  int steps_per_period() const override { return motion_.steps_per_period; }
  void set_position(std::int64_t position) override { position_ = position; }
  void release() override;

  /// The late pulses of all moves so far.
  LatePulses late() const;

 private:
  struct Order {
    std::int64_t target = 0;
    std::stop_token stop = {};
    bool done = false;
    bool arrived = false;
    std::optional<Failure> failure = {};
  };

  void work(const std::stop_token& end);
  void carry_out(Order& order);
  bool turn_to(std::int64_t position, const std::stop_token& stop);
  void switch_on(const std::stop_token& stop);
  void switch_off();
  void report(const LatePulses& late, std::int64_t pulses);

  StepperSettings settings_;
  Motion motion_;
  SetLine set_line_;
  std::atomic<std::int64_t> position_;
  std::atomic<bool> may_have_lost_steps_ = false;  // in the last move
  mutable std::mutex mutex_;  // guards the members that follow; held during a move
  std::condition_variable_any wake_;
  Order* order_ = nullptr;
  bool is_on_ = false;
  bool backlash_taken_up_ = false;
  LatePulses late_ = {};
  std::jthread worker_;  // the last member: it joins before the members that it uses are destroyed
};

/// Drives the lines of the GPIO header that the settings name, as long as the returned function or
/// a copy of it lives.
/// @throws Error "turntable-missing" or "turntable-failed"
Stepper::SetLine open_gpio_lines(const StepperSettings& settings);

}  // namespace octurn
