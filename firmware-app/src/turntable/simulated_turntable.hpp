#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

#include "turntable/motion.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A turntable that moves nothing, but takes a real one's time and reports its angle.
class SimulatedTurntable final : public Turntable {
 public:
  /// @param turned    receives the platform's angle (radians, counter-clockwise seen from above,
  ///                  not wrapped) every 10 ms of a move and at its end, on the moving thread. The
  ///                  angles depend on simulated time only: on a busy machine they come later
  /// @param speed     simulated seconds in a real one
  /// @param position  the initial one, microsteps
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
