#include "doctor/turntable_runner.hpp"

#include <cmath>
#include <utility>

#include "log.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

const Failure scan_is_running{.code = ErrorCode::busy,
                              .detail = "a scan has the turntable",
                              .hint = "Try again when it has ended."};

}  // namespace

TurntableState TurntableRunner::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

bool TurntableRunner::jog(double deg) {
  return start(TurntableState::Doing::jogging, [deg](Rig& rig, const std::stop_token& stop) {
    Turntable& turntable = rig.turntable();
    const double steps = deg / 360 * turntable.steps_per_turn();
    turntable.move_to(turntable.position() + std::llround(steps), stop);
  });
}

bool TurntableRunner::test(const Config& config) {
  return start(
      TurntableState::Doing::testing,
      [this, config](Rig& rig, const std::stop_token& stop) { run_test(rig, config, stop); });
}

void TurntableRunner::stop() {
  const std::lock_guard lock(mutex_);
  stop_.request_stop();
}

bool TurntableRunner::start(TurntableState::Doing doing, Job job) {
  const std::lock_guard lock(mutex_);
  if (state_.doing != TurntableState::Doing::nothing || scanner_.is_busy()) {
    return false;
  }
  state_.doing = doing;
  state_.failure.reset();
  if (doing == TurntableState::Doing::testing) {
    state_.test = TurnTest{};
  }
  stop_ = {};
  // This joins the previous thread, which no longer needs the lock: `end` was its last use.
  thread_ = std::jthread(
      [this, job = std::move(job), stop = stop_.get_token()] { carry_out(job, stop); });
  return true;
}

/// Has the scanner's worker do a job, until `stop` or the worker's own token requests a stop.
void TurntableRunner::carry_out(const Job& job, const std::stop_token& stop) {
  std::optional<Failure> failure;
  try {
    const bool was_called =
        scanner_.check_devices([&](Rig& rig, const std::stop_token& worker_stop) {
          std::stop_source either;
          const auto request = [&] { either.request_stop(); };
          const std::stop_callback from_here(stop, request);
          const std::stop_callback from_worker(worker_stop, request);
          try {
            job(rig, either.get_token());
            rig.release_turntable();
          } catch (const Error&) {  // the next use reopens the devices
            rig.close_sensor();
            rig.close_turntable();
            throw;
          }
          store_.save_platform_angle_deg(rig.platform_angle_deg());
        });
    if (!was_called) {
      failure = scan_is_running;
    }
  } catch (...) {
    failure = current_failure();
    log::warning("turntable", failure->detail);
  }
  end(failure);
}

void TurntableRunner::run_test(Rig& rig, const Config& config, const std::stop_token& stop) {
  const auto show = [this](double done) {
    const std::lock_guard lock(mutex_);
    state_.test->done = done;
  };
  try {
    std::vector<TurnFinding> findings = test_turn(
        rig, config.turntable, config.scan.platform_from_sensor, config.scan.clip, stop, show);
    const std::lock_guard lock(mutex_);
    state_.test->findings = std::move(findings);
    state_.test->state = TurnTest::State::done;
  } catch (const Stopped&) {
    const std::lock_guard lock(mutex_);
    state_.test->state = TurnTest::State::cancelled;
  }
}

void TurntableRunner::end(const std::optional<Failure>& failure) {
  const std::lock_guard lock(mutex_);
  if (failure && state_.doing == TurntableState::Doing::testing) {
    state_.test->state = TurnTest::State::failed;
    state_.test->failure = failure;
  } else {
    state_.failure = failure;
  }
  state_.doing = TurntableState::Doing::nothing;
}

}  // namespace octurn
