#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "turntable/motion.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A turntable that takes the time of a real one. It moves nothing: a listener is told its angle.
class SimulatedTurntable final : public Turntable {
 public:
  /// @param turned    told the platform's angle (radians, counter-clockwise seen from above, not
  ///                  wrapped) every 10 ms of a move and at its end, by the thread that moves it.
  ///                  The angles depend on simulated time alone: a busy machine tells them later
  /// @param speed     times faster than life
  /// @param position  at the beginning
  explicit SimulatedTurntable(std::function<void(double)> turned, double speed = 1,
                              Motion motion = {}, std::int64_t position = 0);

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(std::int64_t position, std::stop_token stop) override;
  std::int64_t position() const override { return position_; }
  int late_pulses() const override { return 0; }
  void release() override {}

 private:
  std::chrono::steady_clock::duration real_time(double seconds) const;
  void stand_at(std::int64_t position);

  std::function<void(double)> turned_;
  double speed_;
  Motion motion_;
  std::int64_t position_;
};

}  // namespace octurn
