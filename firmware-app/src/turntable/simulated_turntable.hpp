#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "turntable/motion.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// A turntable that takes the time of a real one. What turns is whoever listens to it.
class SimulatedTurntable final : public Turntable {
 public:
  /// @param turned  told the angle of the platform (radians, counter-clockwise seen from above, not
  ///                wrapped) about 100 times a second while it moves, and where it stops; called by
  ///                the thread that moves it
  /// @param speed   times faster than life
  /// @param position  where it stands
  explicit SimulatedTurntable(std::function<void(double)> turned, double speed = 1,
                              Motion motion = {}, int position = 0);

  int steps_per_turn() const override { return motion_.steps_per_turn; }
  bool move_to(int position, std::stop_token stop) override;
  int position() const override { return position_; }
  int late_pulses() const override { return 0; }
  void release() override {}

 private:
  std::chrono::steady_clock::duration real_time(double seconds) const;
  bool wait_until(std::chrono::steady_clock::time_point time, const std::stop_token& stop);
  void stand_at(int position);

  std::function<void(double)> turned_;
  double speed_;
  Motion motion_;
  int position_;
  std::mutex mutex_;  // guards nothing: what the condition needs to wait
  std::condition_variable_any wake_;
};

}  // namespace octurn
