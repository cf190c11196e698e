#pragma once

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "app/simulated_frames.hpp"
#include "capture/plan.hpp"
#include "capture/rig.hpp"
#include "latest.hpp"
#include "octurn/error.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {

enum class Fault { none, silent, unplugged, half_blind, line_refused };

/// The real stepper code on lines that only count pulses, and a sensor that shows the object as
/// turned by those pulses. Either fails as a test wants, from one stop of a scan on, until mended.
///
/// The platform's position follows from the motor's pulses alone, not from the program's own count.
class FaultyRig {
 public:
  static constexpr int steps = 800;

  FaultyRig(int stops, std::int64_t position = 0) : stops_(stops), position_(position) {
    static const std::vector<DepthFrame> four_sides = seen_at_stops(4);
    seen_ = stops == 4 ? four_sides : seen_at_stops(stops);
  }

  RigOptions options(double speed, const Retries& retries = {}) {
    return {.speed = speed,
            .stepper = StepperSettings{.speed_deg_per_second = 2250,
                                       .start_speed_deg_per_second = 2250,
                                       .acceleration_deg_per_second2 = 1e6,
                                       .settle_time = std::chrono::milliseconds(0)},
            .retries = retries,
            .open_sensor =
                [this](const std::string&) {
                  if (fails(Fault::unplugged)) {
                    throw Error(ErrorCode::sensor_missing, "none is plugged in", "Plug it in.");
                  }
                  return std::make_unique<Sensor>(*this);
                },
            .open_lines = [this](const StepperSettings&) { return opened_lines(); }};
  }

  /// Lets a fault begin at a stop.
  void fail(Fault fault, int stop) {
    fault_stop_ = stop;
    begun_ = false;
    fault_ = fault;
  }
  void mend() { fault_ = Fault::none; }

  /// Has the sensor send no frame until `let_go`, so that a scan stays at its stop.
  void hold() { is_held_ = true; }
  void let_go() {
    is_held_ = false;
    is_held_.notify_all();
  }

  bool is_motor_on() const { return motor_on_; }
  std::int64_t position() const { return position_; }
  int moves_without_motor() const { return moves_without_motor_; }

  /// Sets the intrinsics of sensors opened from now on.
  void set_lens(const Intrinsics& lens) { lens_.set(lens); }

  /// Delays each pulse.
  void set_pulse_delay(std::chrono::milliseconds delay) { pulse_delay_ = delay; }

  /// Called for each frame, on the thread that reads it.
  std::function<void(int stop)> on_frame = [](int) {};

 private:
  class Sensor final : public DepthSensor {
   public:
    explicit Sensor(FaultyRig& rig) : rig_(rig) {}
    const std::string& name() const override { return name_; }
    const Intrinsics& intrinsics() const override { return intrinsics_; }
    std::string serial() const override { return {}; }
    std::optional<TimedFrame> read(const std::stop_token& stop) override {
      return stop.stop_requested()
                 ? std::nullopt
                 : std::optional(
                       TimedFrame{.frame = rig_.look(), .time = std::chrono::steady_clock::now()});
    }
    std::optional<Tilt> tilt() const override { return std::nullopt; }
    std::optional<int> damaged_frames() const override { return std::nullopt; }
    void show_angle(double /*angle*/) override {}

   private:
    FaultyRig& rig_;
    std::string name_ = "sensor of a test";
    Intrinsics intrinsics_ = *rig_.lens_.get();
  };

  static std::vector<DepthFrame> seen_at_stops(int stops) {
    const auto sensor = open_sensor("octurn-simulator://?noise=0&speed=50");
    std::vector<DepthFrame> seen;
    for (const std::int64_t position : stop_positions(0, steps, stops)) {
      seen.push_back(
          frame_at(*sensor, 2 * std::numbers::pi * static_cast<double>(position) / steps).frame);
    }
    return seen;
  }

  /// Whether this fault is active: it begins at its stop.
  bool fails(Fault fault) {
    if (fault_ != fault) {
      return false;
    }
    const std::int64_t stop =
        stop_positions(0, steps, stops_)[static_cast<std::size_t>(fault_stop_)];
    const std::int64_t begin =
        fault == Fault::line_refused ? std::max<std::int64_t>(stop - 3, 0) : stop;  // in the move
    begun_ = begun_ || position_ >= begin;
    return begun_;
  }

  DepthFrame look() {
    is_held_.wait(true);
    if (fails(Fault::silent)) {
      throw Error(ErrorCode::sensor_silent, "no frame came", "Plug it in again.");
    }
    if (fails(Fault::unplugged)) {
      throw Error(ErrorCode::sensor_lost, "it is gone", "Plug it in again.");
    }
    const std::vector<std::int64_t> at = stop_positions(0, steps, stops_);
    const auto stop = std::ranges::find(at, position_ % steps) - at.begin();
    if (stop == stops_) {
      throw std::logic_error("a frame between two stops, at " + std::to_string(position_));
    }
    on_frame(static_cast<int>(stop));
    DepthFrame frame = seen_[static_cast<std::size_t>(stop)];
    if (fails(Fault::half_blind)) {
      std::fill_n(frame.depth.begin(), frame.depth.size() / 2, std::uint16_t{0});
    }
    return frame;
  }

  Stepper::SetLine opened_lines() {
    if (fails(Fault::line_refused)) {
      throw Error(ErrorCode::turntable_failed, "line GPIO17 is used by another program", "End it.");
    }
    // The driver's pull-up on ENABLE switches the motor off when the lines are released.
    auto lines = std::shared_ptr<void>(nullptr, [this](void*) { motor_on_ = false; });
    return [this, lines, forward = true](Stepper::Line line, bool high) mutable {
      if (fails(Fault::line_refused)) {
        throw Error(ErrorCode::turntable_failed, "line GPIO17 cannot be set", "Look at its wire.");
      }
      if (line == Stepper::Line::enable) {
        motor_on_ = !high;
      } else if (line == Stepper::Line::direction) {
        forward = high;
      } else if (high) {
        std::this_thread::sleep_for(pulse_delay_.load());
        moves_without_motor_ += motor_on_ ? 0 : 1;
        position_ += forward ? 1 : -1;
      }
    };
  }

  int stops_;
  std::vector<DepthFrame> seen_ = {};
  std::atomic<std::int64_t> position_;
  std::atomic<bool> motor_on_ = false;
  std::atomic<int> moves_without_motor_ = 0;
  std::atomic<std::chrono::milliseconds> pulse_delay_ = {};
  Latest<Intrinsics> lens_ = {};
  std::atomic<Fault> fault_ = Fault::none;
  std::atomic<int> fault_stop_ = 0;
  std::atomic<bool> begun_ = false;
  std::atomic<bool> is_held_ = false;
};

}  // namespace octurn
