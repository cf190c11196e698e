#include "scan/status_board.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "log.hpp"
#include "octurn/stl.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// A preview is sent after every snapshot: at most 3 MB, and of leaves as fine as a screen shows.
constexpr double preview_leaf_size = 0.004;  // metres
constexpr std::uint64_t most_preview_facets = 60'000;

DeviceStatus::State state_for(const std::string& code) {
  return code.ends_with("-missing") ? DeviceStatus::State::missing : DeviceStatus::State::failed;
}

void set_failed(DeviceStatus& device, const Failure& failure) {
  if (device.failure.detail != failure.detail) {
    log::warning("scanner", failure.detail);
  }
  device.state = state_for(failure.code);
  device.failure = failure;
}

}  // namespace

nlohmann::json json_of(const DeviceStatus& device) {
  constexpr std::array<std::string_view, 3> states{"ready", "missing", "failed"};
  return {{"state", states[static_cast<std::size_t>(device.state)]},
          {"name", device.name},
          {"simulated", device.simulated},
          {"message", device.failure.detail}};
}

StatusBoard::StatusBoard(const RigOptions& rig) {
  status_.update([&](Status& status) {
    status.sensor.simulated = is_simulated_sensor(rig.sensor_uri);
    status.sensor.failure = {.code = "sensor-missing", .detail = "looking for the sensor"};
    status.turntable.simulated = !rig.stepper;
    status.turntable.name = status.turntable.simulated ? "simulated turntable" : "stepper";
    status.turntable.failure = {.code = "turntable-missing", .detail = "looking for the turntable"};
  });
}

Status StatusBoard::status() const {
  Status status = *status_.get();
  if (status.busy()) {
    const Clock::time_point now = Clock::now();
    status.job->elapsed = now - status.job_started;
    if (status.job_end) {
      status.job->left = std::max(*status.job_end - now, Clock::duration::zero());
    }
  }
  return status;
}

void StatusBoard::set_job(const Job& job) {
  status_.update([&](Status& status) {
    status.job = job;
    status.job_started = Clock::now() - std::chrono::duration_cast<Clock::duration>(job.elapsed);
    status.job_end.reset();
  });
  preview_.set({.id = job.id});
}

void StatusBoard::set_progress(Phase phase, int snapshots_done) {
  status_.update([&](Status& status) {
    Job& job = *status.job;
    if (snapshots_done > job.snapshots_done) {
      job.failure.reset();
    }
    job.phase = phase;
    job.snapshots_done = snapshots_done;
    if (snapshots_done > 0) {
      const Clock::time_point now = Clock::now();
      const auto each = (now - status.job_started) / snapshots_done;
      status.job_end = now + each * (job.settings.snapshots - snapshots_done);
    }
  });
}

void StatusBoard::set_trouble(const Failure& failure) {
  status_.update([&](Status& status) {
    status.job->failure = failure;
    status.job_end.reset();
  });
}

void StatusBoard::set_outcome(const Job& job) {
  status_.update([&](Status& status) {
    if (status.job && status.job->id == job.id) {
      status.job = job;
    }
  });
}

void StatusBoard::set_sensor_ready(const std::string& name) {
  if (status_.get()->sensor.state == DeviceStatus::State::ready) {
    return;
  }
  log::info("scanner", "sensor ready: " + name);
  status_.update([&](Status& status) {
    status.sensor.state = DeviceStatus::State::ready;
    status.sensor.name = name;
    status.sensor.failure = {};
  });
}

void StatusBoard::set_turntable_ready() {
  if (status_.get()->turntable.state == DeviceStatus::State::ready) {
    return;
  }
  log::info("scanner", "turntable ready: " + status_.get()->turntable.name);
  status_.update([&](Status& status) {
    status.turntable.state = DeviceStatus::State::ready;
    status.turntable.failure = {};
  });
}

void StatusBoard::set_sensor_failed(const Failure& failure) {
  view_.set({.time = Clock::now(), .failure = failure});
  status_.update([&](Status& status) { set_failed(status.sensor, failure); });
}

void StatusBoard::set_turntable_failed(const Failure& failure) {
  status_.update([&](Status& status) { set_failed(status.turntable, failure); });
}

void StatusBoard::set_view(const DepthFrame& frame, double depth_unit) {
  view_.set({.time = Clock::now(), .frame = frame, .depth_unit = depth_unit});
}

void StatusBoard::set_preview(const std::string& id, const Reconstructor& seen, int snapshots,
                              const std::stop_token& stop) {
  std::vector<Facet> facets;
  const auto append = [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  };
  seen.preview(preview_leaf_size, most_preview_facets, append, stop);
  if (!facets.empty()) {
    preview_.set({.id = id, .snapshots = snapshots, .stl = stl_text(facets)});
  }
}

}  // namespace octurn
