#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "turntable/loaded_motor.hpp"
#include "turntable/motion.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A turntable that moves nothing, but takes a real one's time and reports its angle.
class SimulatedTurntable final : public Turntable {
 public:
  /// @param turned    receives the platform's angle (radians, counter-clockwise seen from above,
  ///                  not wrapped) every 10 ms of a move and of its settling, and at the end of
  ///                  both, on the moving thread. The angles depend on simulated time only: on a
  ///                  busy machine they come later
  /// @param speed     simulated seconds in a real one
  /// @param position  the initial one, microsteps
  /// @param load      platform on the motor; nothing: it follows each pulse at once
  explicit SimulatedTurntable(std::function<void(double)> turned, double speed = 1,
                              Motion motion = {}, std::int64_t position = 0,
                              const std::optional<PlatformLoad>& load = {});

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(std::int64_t position, std::stop_token stop) override;
  void set_pace(double pace) override { motion_ = at_pace(configured_, pace); }
  std::int64_t position() const override { return position_; }
  int late_pulses() const override { return late_pulses_; }
  bool may_have_lost_steps() const override { return may_have_lost_steps_; }
  int steps_per_period() const override { return motion_.steps_per_period; }
  void set_position(std::int64_t position) override {
    base_ += position_ - position;
    position_ = position;
  }
  void release() override {}

  /// Lets simulated time pass after a move: a heavy platform may still swing.
  void swing(std::chrono::duration<double> time);

  /// Has a pulse of the next move come late. @param pulse  counted from 1
  void delay_pulse(std::int64_t pulse, std::chrono::duration<double> late) {
    late_ = {.pulse = pulse, .by = late.count()};
  }

  /// Where the platform is, radians. Its motor may have lost steps.
  double angle() const;

 private:
  struct Move;
  struct Late {
    std::int64_t pulse = 0;
    double by = 0;  // simulated seconds
  };

  std::chrono::steady_clock::duration real_time(double seconds) const;
  double field() const;
  void plan_pulse(Move& move);
  void make_pulses(Move& move, double until);
  bool settle(const std::stop_token& stop);

  std::function<void(double)> turned_;
  double speed_;
  Motion configured_;
  Motion motion_;
  std::int64_t position_;
  std::int64_t base_ = 0;  // the field's position less `position_`, once that was corrected
  Late late_ = {};
  int late_pulses_ = 0;
  bool may_have_lost_steps_ = false;
  std::optional<LoadedMotor> platform_;
};

}  // namespace octurn
