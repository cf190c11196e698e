// What the worker of a Scanner does.

#include <utility>

#include "log.hpp"
#include "scan/run_scan.hpp"
#include "scan/scanner.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto retry_interval = 2s;     // between attempts at a sensor or turntable that failed
constexpr auto open_without_use = 30s;  // then the sensor is closed: its light and traffic end

// A scan whose device fails tries the same stop again for so long, and once more at least: enough
// for a Kinect that was unplugged and plugged in, which is back after 2 to 3 s.
constexpr auto attempts_time = 30s;

}  // namespace

void Scanner::work(const std::stop_token& stop) {
  Rig rig(rig_options_);
  look_for_turntable(rig);  // so that the status tells what is there
  look(rig, stop);
  while (!stop.stop_requested()) {
    switch (wait_for_demand(stop)) {
      case Demand::scan:
        run_order(rig, stop);
        break;
      case Demand::view:
        look(rig, stop);
        break;
      case Demand::loan:
        lend(rig, stop);
        break;
      case Demand::none:
        rig.close_sensor();
        break;
    }
  }
  end_loan();
}

Scanner::Demand Scanner::wait_for_demand(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto viewed = [&] { return Clock::now() < view_wanted_until_; };
  wake_.wait_for(lock, stop, open_without_use,
                 [&] { return order_ || loan_ != nullptr || viewed(); });
  if (stop.stop_requested()) {
    return Demand::none;
  }
  return order_             ? Demand::scan
         : loan_ != nullptr ? Demand::loan
         : viewed()         ? Demand::view
                            : Demand::none;
}

void Scanner::look(Rig& rig, const std::stop_token& stop) {
  if (board_.latest_status().get()->turntable.state != DeviceStatus::State::ready) {
    look_for_turntable(rig);  // whose lines may have become free since
  }
  try {
    DepthSensor& sensor = rig.sensor();
    if (const std::optional<TimedFrame> timed = sensor.read(stop)) {
      board_.set_view(timed->frame, sensor.intrinsics().depth_unit);
      board_.set_sensor_ready(sensor.name());
    }
  } catch (...) {
    const Failure failure = current_failure();
    rig.close_sensor();
    board_.set_sensor_failed(failure);
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, retry_interval, [&] { return order_ || loan_ != nullptr; });
  }
}

void Scanner::look_for_turntable(Rig& rig) {
  try {
    rig.turntable();
    board_.set_turntable_ready();
  } catch (...) {
    board_.set_turntable_failed(current_failure());
  }
}

void Scanner::run_order(Rig& rig, const std::stop_token& stop) {
  Job job;
  std::stop_source cancel;
  {
    const std::lock_guard lock(mutex_);
    job = order_->job;
    cancel = order_->cancel;
  }
  const std::stop_callback end_with_the_daemon(stop, [&] { cancel.request_stop(); });
  {
    std::unique_lock lock(mutex_);
    wake_.wait(lock, cancel.get_token(), [&] { return !leave_; });
  }
  log::info("scanner", "scan " + job.id +
                           " started, snapshots=" + std::to_string(job.settings.snapshots) +
                           ", of which taken=" + std::to_string(job.snapshots_done));
  const int late_before = rig.late_pulses();
  run_until_it_ends(job, rig, cancel.get_token());
  if (job.state == JobState::cancelled && stop.stop_requested()) {
    job.state = JobState::interrupted;
    job.failure = interruption();
  }
  let_go(rig);
  job.late_pulses += rig.late_pulses() - late_before;
  finish(std::move(job));
}

/// Tries a stop again where a device fails, until that has lasted too long: then the scan pauses.
void Scanner::run_until_it_ends(Job& job, Rig& rig, const std::stop_token& stop) {
  const auto at_speed = [&](std::chrono::duration<double> life) {
    return std::chrono::duration_cast<Clock::duration>(life / rig_options_.speed);
  };
  int failed_at = -1;  // snapshots that were done then
  Clock::time_point last_attempt = {};
  for (;;) {
    attempt(job, rig, stop);
    if (job.state != JobState::paused) {
      return;
    }
    const Clock::time_point now = Clock::now();
    if (job.snapshots_done > failed_at) {
      failed_at = job.snapshots_done;
      last_attempt = now + at_speed(attempts_time);
    }
    if (now >= last_attempt) {
      job.failure->hint += " Then resume the scan.";
      return;
    }
    board_.set_trouble(*job.failure);
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, at_speed(retry_interval), [] { return false; });
    if (stop.stop_requested()) {
      job.state = JobState::cancelled;
      job.failure.reset();
      return;
    }
  }
}

/// Runs a scan from where it stands to its end, or until something fails. A device that failed is
/// closed, so that the next use opens it again.
void Scanner::attempt(Job& job, Rig& rig, const std::stop_token& stop) {
  try {
    job.model = run_scan(
        job.settings, limits_, store_.folder(job.id), rig, stop,
        {.on_progress =
             [&](Phase phase, int done) {
               board_.set_progress(phase, done);
               if (phase == Phase::capturing) {
                 board_.set_turntable_ready();  // it has turned
               }
             },
         .on_turn = [&](double angle_deg) { save_platform_angle(angle_deg); },
         .on_frame =
             [&](const DepthFrame& frame, double depth_unit) {
               board_.set_view(frame, depth_unit);
               board_.set_sensor_ready(rig.sensor().name());
             },
         .on_added = [&](const Reconstructor& seen,
                         int snapshots) { board_.set_preview(job.id, seen, snapshots, stop); }});
    job.state = job.model ? JobState::finished : JobState::cancelled;
    job.failure.reset();
  } catch (...) {
    job.failure = current_failure();
    job.state = is_device_fault(*job.failure) ? JobState::paused : JobState::failed;
    if (job.failure->code.starts_with("sensor-")) {
      board_.set_sensor_failed(*job.failure);
      rig.close_sensor();
    } else if (job.failure->code.starts_with("turntable-")) {
      board_.set_turntable_failed(*job.failure);
      rig.close_turntable();
    }
  }
  job.snapshots_done = board_.latest_status().get()->job->snapshots_done;
}

void Scanner::lend(Rig& rig, const std::stop_token& stop) {
  Loan* loan = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (loan_ == nullptr) {
      return;  // a scan has come before it
    }
    loan = loan_;
    loan->taken = true;
  }
  try {
    const std::stop_callback end_with_the_daemon(stop, [&] { loan->stop.request_stop(); });
    loan->use(rig, loan->stop.get_token());
    loan->used = true;
  } catch (...) {
    loan->failure = std::current_exception();
  }
  end_loan();  // after which the loan is gone
}

/// Lets whoever waits for the rig go on, with it or without.
void Scanner::end_loan() {
  const std::lock_guard lock(mutex_);
  if (loan_ != nullptr) {
    loan_->done = true;
    loan_ = nullptr;
  }
  wake_.notify_all();
}

void Scanner::let_go(Rig& rig) {
  try {
    rig.release_turntable();
  } catch (...) {
    board_.set_turntable_failed(current_failure());
    rig.close_turntable();  // without its lines the motor is off too
  }
  save_platform_angle(rig.platform_angle_deg());
}

/// So that a scan that this program does not see the end of can be resumed by its next run.
void Scanner::save_platform_angle(double angle_deg) {
  try {
    store_.save_platform_angle_deg(angle_deg);
  } catch (...) {
    log::warning("scanner", current_failure().detail);
  }
}

void Scanner::finish(Job job) {
  job.phase = Phase::done;
  job.elapsed = status().job->elapsed;
  if (job.failure) {
    log::error("scanner", "scan " + job.id + " " + std::string(name_of(job.state)) + ": " +
                              job.failure->detail);
  } else {
    log::info("scanner", "scan " + job.id + " " + std::string(name_of(job.state)));
  }
  const std::lock_guard lock(mutex_);
  try {
    store_.save(job);
  } catch (...) {
    // On the disk it still runs, and the next start will call it interrupted.
    log::error("scanner", current_failure().detail);
  }
  board_.set_outcome(job);
  order_.reset();
}

}  // namespace octurn
