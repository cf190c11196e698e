#include "run/status_board.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "log.hpp"
#include "octurn/median.hpp"

namespace octurn {
namespace {

constexpr std::size_t stops_of_pace = 5;
constexpr std::size_t min_stops_of_pace = 2;
constexpr double max_rise = 1.1;

using Clock = Status::Clock;

bool is_ready(const DeviceStatus& device) { return device.state == DeviceStatus::State::ready; }

void set_failed(DeviceStatus& device, const Failure& failure) {
  if (device.failure.detail != failure.detail) {
    log::warning("scanner", failure.detail);
  }
  device.state = failure.is_absence() ? DeviceStatus::State::missing : DeviceStatus::State::failed;
  device.failure = failure;
}

}  // namespace

Seconds ExpectedEnd::left(Clock::time_point now) const {
  return std::max(Seconds(end - now), later);
}

TimeLeft::TimeLeft(const ScanEstimate& before, int stops, int snapshots, Clock::time_point now)
    : before_(before), stops_(stops), snapshots_(snapshots) {
  tell_turn(now);
}

/// Ignores the time of the first snapshot: the platform may stand there already, and the sensor may
/// have to be opened.
void TimeLeft::count(int snapshots, Clock::time_point now) {
  if (snapshots <= snapshots_) {
    return;
  }
  if (last_) {
    pace_.push_back(Seconds(now - *last_).count());
    if (pace_.size() > stops_of_pace) {
      pace_.erase(pace_.begin());
    }
  }
  last_ = now;
  snapshots_ = snapshots;
  tell_turn(now);
}

void TimeLeft::tell_turn(Clock::time_point now) {
  const bool has_pace = pace_.size() >= min_stops_of_pace;
  if (!has_pace && !before_.is_measured) {
    return;
  }
  const Seconds stop = has_pace ? Seconds(median(pace_)) : before_.stop;
  const Seconds left = stop * (stops_ - snapshots_ + 1) + before_.build;
  tell(left, left - stop, now);
}

void TimeLeft::begin_model(Clock::time_point now) { tell(before_.build, Seconds(0), now); }

void TimeLeft::count_model(double share, Clock::time_point since, Clock::time_point now) {
  if (share > 0) {
    tell(Seconds(now - since) * (1 - share) / share, Seconds(0), now);
  }
}

void TimeLeft::lose_pace() {
  last_.reset();
  expected_.reset();
}

void TimeLeft::tell(Seconds left, Seconds later, Clock::time_point now) {
  if (expected_) {
    left = std::min(left, max_rise * expected_->left(now));
  }
  expected_ = {.end = now + std::chrono::duration_cast<Clock::duration>(left),
               .later = std::min(later, left)};
}

nlohmann::json to_json(const DeviceStatus& device) {
  constexpr std::array<std::string_view, 4> states{"unknown", "ready", "missing", "failed"};
  return {{"state", states[static_cast<std::size_t>(device.state)]},
          {"name", device.name},
          {"simulated", device.simulated},
          {"message", device.failure.detail}};
}

StatusBoard::StatusBoard(const RigOptions& rig) {
  status_.update([&](Status& status) {
    status.sensor.simulated = rig.simulates_sensor();
    status.turntable.simulated = !rig.stepper;
    status.turntable.name = status.turntable.simulated ? "simulated turntable" : "stepper";
  });
}

Status StatusBoard::status() const {
  Status status = *status_.get();
  if (status.is_scanning()) {
    const Clock::time_point now = Clock::now();
    status.job->times.elapsed = now - status.job_started;
    if (status.job_end) {
      status.job->times.left = status.job_end->left(now);
    }
    if (status.job_gives_up) {
      status.job->times.until_pause = std::max(*status.job_gives_up - now, Clock::duration::zero());
    }
  }
  return status;
}

void StatusBoard::begin_scan(const Job& job, Clock::time_point started) {
  status_.update([&](Status& status) {
    status.job = job;
    status.job_started = started;
    status.job_end.reset();
    status.job_gives_up.reset();
  });
  mesh_preview_.set({.id = job.id});
}

void StatusBoard::set_job(const Job& job, const std::optional<ExpectedEnd>& expected_end,
                          const std::optional<Clock::time_point>& gives_up) {
  status_.update([&](Status& status) {
    if (status.job && status.job->id == job.id) {
      ScanLabel label = std::move(status.job->label);
      status.job = job;
      status.job->label = std::move(label);
      status.job_end = expected_end;
      status.job_gives_up = gives_up;
    }
  });
}

void StatusBoard::label(std::string_view id, const LabelChange& change) {
  status_.update([&](Status& status) {
    if (status.job && status.job->id == id) {
      status.job->label = changed(status.job->label, change);
    }
  });
}

void StatusBoard::set_sensor_ready(const std::string& name) {
  if (const auto now = status_.get(); is_ready(now->sensor) && now->sensor.name == name) {
    return;  // called for every frame: publishes changes only
  }
  status_.update([&](Status& status) {
    if (!is_ready(status.sensor)) {
      log::info("scanner", "sensor ready: " + name);
    }
    status.sensor.state = DeviceStatus::State::ready;
    status.sensor.name = name;
    status.sensor.failure = {};
  });
}

void StatusBoard::set_turntable_ready() {
  if (is_ready(status_.get()->turntable)) {
    return;
  }
  status_.update([&](Status& status) {
    log::info("scanner", "turntable ready: " + status.turntable.name);
    status.turntable.state = DeviceStatus::State::ready;
    status.turntable.failure = {};
  });
}

void StatusBoard::set_sensor_failed(const Failure& failure) {
  status_.update([&](Status& status) { set_failed(status.sensor, failure); });
  // Published after the status, which is read by those who wait for a frame.
  camera_frame_.set({.time = Clock::now(), .failure = failure});
}

void StatusBoard::set_turntable_failed(const Failure& failure) {
  status_.update([&](Status& status) { set_failed(status.turntable, failure); });
}

void StatusBoard::set_camera_frame(DepthFrame frame, const Intrinsics& lens) {
  camera_frame_.set({.time = Clock::now(), .frame = std::move(frame), .lens = lens});
}

void StatusBoard::set_camera_picture(Picture picture) {
  camera_frame_.set({.time = Clock::now(), .picture = std::move(picture)});
}

void StatusBoard::set_sensor_closed() {
  known_sensor_.update([](KnownSensor& sensor) { sensor.since.reset(); });
}

void StatusBoard::clear_sensor_map() {
  known_sensor_.update([](KnownSensor& sensor) { sensor.map.reset(); });
}

void StatusBoard::set_optics(std::vector<OpticsRecord> optics,
                             std::optional<SensorMapSummary> map) {
  known_sensor_.update([&](KnownSensor& sensor) {
    sensor.optics = std::move(optics);
    sensor.map = std::move(map);
  });
}

void StatusBoard::set_lens(std::optional<KeptLens> lens) {
  known_sensor_.update([&](KnownSensor& sensor) { sensor.lens = lens; });
}

void StatusBoard::forget_calibration_run() { calibration_run_.set(std::nullopt); }

void StatusBoard::set_calibration_run(CalibrationRun run) {
  const bool is_running = run.state == CalibrationRun::State::running;
  calibration_run_.set(std::move(run));
  status_.update([&](Status& status) { status.is_measuring = is_running; });
}

void StatusBoard::set_build_run(BuildRun run) {
  const bool is_building = !run.has_ended();
  build_run_.set(std::move(run));
  status_.update([&](Status& status) { status.is_building = is_building; });
}

void StatusBoard::drop_waiting_build(const std::optional<Failure>& reason) {
  std::optional<BuildRun> run = *build_run_.get();
  if (run && run->state == BuildRun::State::waiting) {
    run->state = BuildRun::State::cancelled;
    run->phase = Phase::done;
    run->failure = reason;
    set_build_run(*std::move(run));
  }
}

}  // namespace octurn
