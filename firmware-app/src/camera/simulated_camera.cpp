#include "camera/simulated_camera.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "module.hpp"
#include "rig/interruptible_sleep.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

constexpr double pictures_per_second = 15;

/// Which laser is on; nothing: none is.
using Lit = std::optional<std::size_t>;

class SimulatedCamera final : public Camera {
 public:
  SimulatedCamera(std::unique_ptr<LaserSimulator> simulator, std::shared_ptr<const Lit> lit,
                  double speed, int late)
      : simulator_(std::move(simulator)),
        lit_(std::move(lit)),
        late_(static_cast<std::size_t>(late)),
        period_(std::chrono::duration_cast<steady_clock::duration>(
            std::chrono::duration<double>(1 / (pictures_per_second * speed)))) {}

  const std::string& name() const override { return name_; }
  std::string serial() const override { return "simulated-laser"; }

  std::optional<TimedPicture> read(const std::stop_token& stop) override {
    const auto begin = wait(stop);
    if (!begin) {
      return std::nullopt;
    }
    const State seen = seen_now();
    return TimedPicture{.picture = shows_board_ ? simulator_->expose_board(board_pictures_++)
                                                : simulator_->expose(seen.angle, seen.lit),
                        .begin = *begin};
  }

  std::optional<TimedPicture> read_in_colour(const std::stop_token& stop) override {
    const auto begin = wait(stop);
    if (!begin) {
      return std::nullopt;
    }
    const State state = seen_now();
    ColourExposure seen = simulator_->expose_in_colour(state.angle, state.lit);
    return TimedPicture{
        .picture = std::move(seen.picture), .colours = std::move(seen.colours), .begin = *begin};
  }

  void show_angle(double angle) override { angle_ = angle; }
  void set_object_pose(int pose) override { simulator_->set_object_pose(pose); }
  void show_board(bool is_shown) override {
    shows_board_ = is_shown;
    board_pictures_ = 0;
  }

 private:
  /// What a picture shows.
  struct State {
    double angle = 0;  // of the platform, radians
    Lit lit = {};
  };

  /// What the picture shows that is handed out now: platform and lasers as they were some pictures
  /// ago.
  State seen_now() {
    states_.push_back({.angle = angle_, .lit = *lit_});
    if (states_.size() > late_ + 1) {
      states_.pop_front();
    }
    return states_.front();
  }

  /// Waits until the next picture begins. @return nothing if stopped first
  std::optional<steady_clock::time_point> wait(const std::stop_token& stop) {
    if (!sleep_until(stop, due_)) {
      return std::nullopt;
    }
    const steady_clock::time_point begin = steady_clock::now();
    due_ = std::max(due_ + period_, begin);
    return begin;
  }

  std::string name_ = "Laser line (simulated)";
  std::unique_ptr<LaserSimulator> simulator_;
  std::shared_ptr<const Lit> lit_;
  std::size_t late_;               // pictures
  std::deque<State> states_ = {};  // when the last pictures were read, the oldest first
  steady_clock::duration period_;
  steady_clock::time_point due_ = {};  // the next picture
  double angle_ = 0;                   // of the platform, radians
  bool shows_board_ = false;
  int board_pictures_ = 0;  // since it is shown
};

}  // namespace

CameraAndLasers simulate_laser_rig(const LaserSimulation& simulation, double speed, int late) {
  const auto& module = *static_cast<const LaserSimulatorModule*>(
      load_module("libOcturnLaserSimulator.so", "octurn_laser_simulator", "the laser simulator",
                  "Install Octurn again."));
  const auto lit = std::make_shared<Lit>();
  return {.camera = std::make_unique<SimulatedCamera>(module.make(simulation), lit, speed, late),
          .set_line = [lit](std::size_t laser, bool on) {
            if (on) {
              *lit = laser;
            } else if (*lit == laser) {
              lit->reset();
            }
          }};
}

}  // namespace octurn
