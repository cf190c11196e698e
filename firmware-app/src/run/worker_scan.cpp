// Worker: running a scan.

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calibration/sensor_map_files.hpp"
#include "calibration/solve_pose.hpp"
#include "log.hpp"
#include "octurn/stl.hpp"
#include "run/worker.hpp"
#include "store/earlier_scans.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

// A preview is sent after every snapshot: at most 3 MB, with leaves as fine as a screen shows.
constexpr double preview_leaf_size = 0.002;  // metres
constexpr std::uint64_t max_preview_facets = 60'000;

std::string to_text(const ScanSolution& solution) {
  return solution.replaces_told     ? "its pose is solved, the model is built again"
         : solution.report.accepted ? "the configured pose is right"
                                    : "the configured pose stays in use: " + solution.report.reason;
}

/// Returns the index of the object's pose in a scan: 0 in a first scan, 1, 2, ... in those of other
/// poses.
std::size_t to_pose_index(const ScanStore& store, const Job& job) {
  if (!job.pose_of) {
    return 0;
  }
  const std::vector<Job> poses = store.poses(job.pose_of->scan);
  const auto own = std::ranges::find(poses, job.id, &Job::id);
  return static_cast<std::size_t>(own - poses.begin()) + 1;
}

bool is_of_turn(Phase phase) {
  return phase == Phase::starting || phase == Phase::turning || phase == Phase::capturing;
}

MeshPreview make_preview(const std::string& id, const Reconstructor& reconstruction, int snapshots,
                         const std::stop_token& stop) {
  std::vector<Facet> facets;
  const auto append = [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  };
  reconstruction.preview(preview_leaf_size, max_preview_facets, append, stop);
  return facets.empty() ? MeshPreview{.id = id}
                        : MeshPreview{.id = id, .snapshots = snapshots, .stl = stl_text(facets)};
}

}  // namespace

void Worker::run(Job job, const std::stop_token& stop) {
  ports_.board.drop_waiting_build(displaced_by_scan());  // this command replaced it
  job_ = std::move(job);
  job_started_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(job_.times.elapsed);
  time_left_.emplace(estimate_scan(earlier_scans(ports_.store), job_.settings),
                     job_.settings.snapshots, job_.snapshots_done, Clock::now());
  gives_up_.reset();
  show_job();
  log::info("scanner", "scan " + job_.id +
                           " started, snapshots=" + std::to_string(job_.settings.snapshots) +
                           ", of which taken=" + std::to_string(job_.snapshots_done));
  const int late_before = rig_.late_pulses();
  try {
    run_until_it_ends(stop);
  } catch (...) {
    job_.failure = current_failure();
    job_.state = JobState::failed;
  }
  if (job_.state == JobState::cancelled && ports_.slot.has_ended()) {
    job_ = to_interrupted(job_, job_.snapshots_done);
  } else if (job_.state == JobState::cancelled && ports_.slot.scan_stop() == ScanStop::pause) {
    job_.state = JobState::paused;
  }
  release_rig();
  job_.times.late_pulses += rig_.late_pulses() - late_before;
  finish();
}

/// Retries a stop at which a device fails; the scan pauses after `retries_.time`.
void Worker::run_until_it_ends(const std::stop_token& stop) {
  const auto at_speed = [&](std::chrono::duration<double> life) {
    return std::chrono::duration_cast<Clock::duration>(life / speed_);
  };
  int failed_at = -1;  // number of snapshots at the last new failure
  while (!stop.stop_requested()) {
    attempt(stop);
    if (job_.state != JobState::paused) {
      return;
    }
    const Clock::time_point now = Clock::now();
    if (job_.snapshots_done > failed_at) {
      failed_at = job_.snapshots_done;
      gives_up_ = now + at_speed(retries_.time);
    }
    if (now >= *gives_up_) {
      job_.failure->hint += " Then resume the scan.";
      return;
    }
    job_.state = JobState::running;
    time_left_->lose_pace();
    show_job();
    ports_.heartbeat.beat();
    ports_.slot.wait_for_command(at_speed(retries_.interval));
  }
  job_.state = JobState::cancelled;
  job_.failure.reset();
}

/// Runs a scan from its next stop to its end, or until something fails. A device that failed is
/// closed, so that the next use opens it again.
void Worker::attempt(const std::stop_token& stop) {
  try {
    rig_.set_object_pose(static_cast<int>(to_pose_index(ports_.store, job_)));
    use_lens(first_scan());
    use_pose();
    if (job_.snapshots_done == 0) {
      expect_same_sensor();
      if (rig_.laser() == nullptr) {
        keep_sensor_map(ports_.store.data(), rig_.sensor().serial(), ports_.store.folder(job_.id));
      }
    }
    job_.model =
        run_scan(job_.settings, limits_, ports_.store.folder(job_.id), rig_, stop, observer(stop));
    job_.state = job_.model && join(stop) ? JobState::finished : JobState::cancelled;
    job_.failure.reset();
  } catch (...) {
    job_.failure = current_failure();
    job_.state = job_.failure->device() == Device::none ? JobState::failed : JobState::paused;
    close_device(*job_.failure);
  }
}

ScanObserver Worker::observer(const std::stop_token& stop) {
  return {.on_progress = [this](Phase phase, int done) { show_progress(phase, done); },
          .on_turn = [this](double angle_deg) { save_platform_angle(angle_deg); },
          .on_frame = [this](const DepthFrame& frame) { show_frame(frame); },
          .on_picture = [this](const Picture& picture) { show_picture(picture); },
          .on_added =
              [this, stop, id = job_.id](const Reconstructor& reconstruction, int snapshots) {
                if (MeshPreview preview = make_preview(id, reconstruction, snapshots, stop);
                    preview.snapshots > 0) {
                  ports_.board.set_mesh_preview(std::move(preview));
                }
              },
          .on_calibrated = [this](const ScanSolution& solution) { keep_calibration(solution); },
          .on_rebuilt = [this](int snapshots) { show_rebuilt(snapshots); },
          .on_wait = [this] { ports_.heartbeat.beat(); }};
}

void Worker::show_progress(Phase phase, int snapshots_done) {
  const Clock::time_point now = Clock::now();
  const bool is_stop_done = snapshots_done > job_.snapshots_done;
  if (is_stop_done) {
    job_.failure.reset();
    gives_up_.reset();
  }
  if (is_of_turn(job_.phase) && !is_of_turn(phase)) {
    time_left_->begin_model(now);
  }
  time_left_->count(snapshots_done, now);
  job_.phase = phase;
  job_.snapshots_done = snapshots_done;
  if (is_stop_done && snapshots_done == 1 && rig_.laser() != nullptr) {
    const std::filesystem::path folder = ports_.store.folder(job_.id);
    job_.builds.have_colours = has_colours(folder, read_scan(folder));
  }
  if (phase == Phase::rebuilding) {
    rebuild_started_ = now;
  }
  show_job();
  if (is_stop_done) {
    save_progress();
  }
  begin(phase);
}

void Worker::show_job() { ports_.board.set_job(job_, time_left_->expected(), gives_up_); }

/// Saves the job, so that a scan that is interrupted here resumes with its elapsed time.
void Worker::save_progress() {
  job_.times.elapsed = Clock::now() - job_started_;
  try {
    ports_.store.save(job_);
  } catch (...) {
    log::warning("scanner", current_failure().detail);
  }
}

/// Updates heartbeat and turntable at the start of a phase of a scan or a turn.
void Worker::begin(Phase phase) {
  if (phase == Phase::capturing) {  // the platform has turned
    set_turntable_ready();
    ports_.heartbeat.beat();
  } else {
    ports_.heartbeat.suspend();  // a whole turn, or a model, may take minutes
  }
}

/// Saves the result at once, in case the program is killed while the model is built again. The next
/// scan starts with the pose and the planes that this one solved.
void Worker::keep_calibration(const ScanSolution& solution) {
  const CalibrationReport& report = solution.report;
  job_.calibration = to_scan_calibration(report);
  job_.calibration->confirms_told = report.accepted && !solution.replaces_told;  // planes, too
  log::info("scanner", "scan " + job_.id + ": " + to_text(solution));
  show_job();
  try {
    ports_.store.save(job_);
    if (solution.replaces_told) {
      ports_.calibration.set(rig_.laser() == nullptr
                                 ? to_record(report, PoseOrigin::scan, job_.settings.depth_scale)
                                 : to_record(report, PoseOrigin::scan, rig_.camera().serial(),
                                             solution.solved.lasers));
    }
  } catch (...) {
    log::warning("scanner", current_failure().detail);
  }
}

void Worker::show_rebuilt(int snapshots) {
  if (job_.calibration) {
    job_.calibration->rebuilt = snapshots;
  }
  if (job_.snapshots_done > 0) {
    time_left_->count_model(static_cast<double>(snapshots) / job_.snapshots_done, rebuild_started_,
                            Clock::now());
  }
  show_job();
}

void Worker::close_device(const Failure& failure) {
  if (failure.device() == Device::sensor) {
    set_sensor_failed(failure);
    rig_.close_sensor();
    ports_.board.set_sensor_closed();
  } else if (failure.device() == Device::turntable) {
    set_turntable_failed(failure);
    rig_.close_turntable();
  }
}

void Worker::release_rig() {
  try {
    rig_.release_turntable();
  } catch (...) {
    set_turntable_failed(current_failure());
    rig_.close_turntable();  // without its lines the motor is off too
  }
  save_platform_angle(rig_.platform_angle_deg());
}

/// Saves the angle, so that a scan that this process does not finish can be resumed by the next
/// one.
void Worker::save_platform_angle(double angle_deg) {
  try {
    ports_.store.save_platform_angle_deg(angle_deg);
  } catch (...) {
    log::warning("scanner", current_failure().detail);
  }
}

void Worker::finish() {
  job_.phase = Phase::done;
  job_.times.elapsed = Clock::now() - job_started_;
  const std::string outcome = "scan " + job_.id + " " + std::string(to_string(job_.state));
  if (job_.failure) {
    log::error("scanner", outcome + ": " + job_.failure->detail);
  } else {
    log::info("scanner", outcome);
  }
  const std::lock_guard lock(ports_.scans);
  try {
    ports_.store.save(job_);
  } catch (...) {
    // The job.json on the disk says that the scan runs: it is interrupted, as after a restart.
    log::error("scanner", current_failure().detail);
    job_ = ports_.store.interrupt(job_.id);
  }
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_job(job_);
}

}  // namespace octurn
