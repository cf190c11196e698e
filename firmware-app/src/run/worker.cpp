#include "run/worker.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "build/build_model.hpp"
#include "build/merged_scan.hpp"
#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/wall_views.hpp"
#include "log.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/stl.hpp"
#include "run/command_slot.hpp"
#include "store/scan_estimate.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr auto retry_interval = 2s;  // between attempts to read a failed sensor
constexpr auto idle_beat = 5s;       // between heartbeats while there is nothing to do

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

PoseRegistration to_pose_registration(const Registration& registration) {
  PoseRegistration found{.accepted = registration.accepted,
                         .reason = registration.reason,
                         .candidates = registration.candidates};
  if (registration.accepted) {
    found.pose = registration.poses.back();
    found.candidate = 0;
  }
  return found;
}

/// Builds the model into the build's folder, and adds it to the store.
/// @return false if stopped first
bool build_and_keep(const BuildCommand& command, const Limits& limits, const WorkerPorts& ports,
                    const std::stop_token& stop) {
  const BuildRun& run = command.run;
  const auto show = [&](Phase phase, int done) {
    BuildRun now = run;
    now.phase = phase;
    now.snapshots_done = done;
    ports.board.set_build_run(std::move(now));
  };
  if (command.pose) {
    return refit_pose(ports.store, run, *command.pose, limits, stop, show);
  }
  const std::filesystem::path file = ports.store.begin_build(run.scan, run.number);
  const BuildTask task = make_task(ports.store, run, command.becomes_model);
  const std::optional<Build> build = build_model(task, limits, file, stop, show);
  if (!build) {
    return false;
  }
  ports.store.add_build(run.scan, *build);
  choose_built(ports.store, task);
  return true;
}

/// Makes the record of an accepted turn. A confirmed pose is the configured one, bit for bit.
PoseRecord to_record(const TurnReport& report, const ScanSettings& settings, Capture& capture) {
  PoseRecord record =
      capture.to_record(report.calibration, PoseOrigin::turn, settings,
                        report.replaces_told ? report.lasers : report.configured_lasers);
  if (!report.replaces_told) {
    record.platform_from_sensor = report.configured_pose;
  }
  return record;
}

/// Describes the outcome of a run, for the log.
std::string describe_outcome(const CalibrationRun& run) {
  const std::string reason = run.report ? run.report->calibration.reason
                             : run.wall ? run.wall->reason
                             : run.lens ? run.lens->reason
                                        : "";
  switch (run.state) {
    case CalibrationRun::State::done:
      return "accepted";
    case CalibrationRun::State::refused:
      return "refused: " + reason;
    default:
      return "cancelled";
  }
}

/// Whether optics are the same but for the depth scale, which each scan sets.
bool are_alike(SensorOptics one, const SensorOptics& other) {
  one.depth_scale = other.depth_scale;
  return one == other;
}

}  // namespace

Worker::Worker(const RigOptions& rig, const Limits& limits, const WorkerPorts& ports)
    : rig_(rig),
      speed_(rig.speed),
      retries_(rig.retries),
      sensor_off_after_(rig.sensor_off_after),
      limits_(limits),
      ports_(ports),
      capture_(make_capture(rig_, ports.store.data(), &ports.calibration)) {}

void Worker::work() {
  open_turntable();  // so that the status shows it
  Clock::time_point last_use = Clock::now();
  for (;;) {
    ports_.heartbeat.beat();
    std::optional<CommandSlot::Taken> taken = ports_.slot.take(idle_beat);
    if (taken) {
      carry_out(*taken);
      last_use = Clock::now();
    } else if (ports_.slot.has_ended()) {
      return;
    } else if (sensor_off_after_ && Clock::now() - last_use >= *sensor_off_after_) {
      rig_.close_sensor();
      ports_.board.set_sensor_closed();
    }
  }
}

/// Executes a command, and catches its exceptions, so that the worker outlives them.
void Worker::carry_out(CommandSlot::Taken& taken) {
  try {
    std::visit([&](auto& command) { carry_out(command, taken.stop); }, taken.command);
  } catch (...) {
    log::error("scanner", current_failure().detail);
  }
  ports_.slot.finish();
}

void Worker::carry_out(CameraCommand& /*command*/, const std::stop_source& stop) {
  if (!ports_.devices.get()->turntable_is_ready) {
    open_turntable();  // its GPIO lines may be free now
  }
  try {
    show_next_frame(stop.get_token());
  } catch (...) {
    const Failure failure = current_failure();
    rig_.close_sensor();
    ports_.board.set_sensor_closed();
    set_sensor_failed(failure);
    ports_.slot.wait_for_command(retry_interval);
  }
}

void Worker::show_next_frame(const std::stop_token& stop) {
  if (std::optional<SeenImage> seen = capture_->read(stop)) {
    std::visit([this](auto image) { show(std::move(image)); }, *std::move(seen));
  }
}

void Worker::show(DepthFrame frame) {
  DepthSensor& sensor = rig_.sensor();
  ports_.heartbeat.beat();
  set_sensor_ready(sensor.name());
  introduce_sensor();
  ports_.board.set_camera_frame(std::move(frame), sensor.intrinsics());
}

void Worker::show(Picture picture) {
  ports_.heartbeat.beat();
  set_sensor_ready(capture_->sensor().name);
  introduce_sensor();
  ports_.board.set_camera_picture(std::move(picture));
}

void Worker::carry_out(DeviceCheckCommand& command, const std::stop_source& stop) {
  ports_.heartbeat.suspend();  // a slow turntable takes minutes for a turn
  command.check(rig_, stop.get_token());
}

void Worker::carry_out(RebuildCommand& command, const std::stop_source& /*stop*/) {
  ports_.heartbeat.suspend();
  rebuild(command);
}

void Worker::carry_out(ScanCommand& command, const std::stop_source& stop) {
  run(std::move(command.job), stop.get_token());
}

void Worker::carry_out(ResumeCommand& command, const std::stop_source& stop) {
  run(std::move(command.job), stop.get_token());
}

void Worker::open_turntable() {
  try {
    rig_.turntable();
    set_turntable_ready();
  } catch (...) {
    set_turntable_failed(current_failure());
  }
}

// A state is set before it is shown: clients act on what they see.

void Worker::set_sensor_ready(const std::string& name) {
  ports_.devices.update([](DeviceStates& devices) { devices.sensor_is_ready = true; });
  ports_.board.set_sensor_ready(name);
}

void Worker::set_sensor_failed(const Failure& failure) {
  ports_.devices.update([](DeviceStates& devices) { devices.sensor_is_ready = false; });
  ports_.board.set_sensor_failed(failure);
}

void Worker::set_turntable_ready() {
  ports_.devices.update([](DeviceStates& devices) {
    devices.turntable_is_ready = true;
    devices.turntable_failure.reset();
  });
  ports_.board.set_turntable_ready();
}

void Worker::set_turntable_failed(const Failure& failure) {
  ports_.devices.update([&](DeviceStates& devices) {
    devices.turntable_is_ready = false;
    devices.turntable_failure = failure;
  });
  ports_.board.set_turntable_failed(failure);
}

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
    capture_->use_stored(job_.settings, first_scan());
    if (job_.snapshots_done == 0) {
      expect_same_sensor();
      capture_->keep_sensor_map(ports_.store.folder(job_.id));
    }
    job_.model = run_scan(job_.settings, limits_, ports_.store.folder(job_.id), *capture_, stop,
                          observer(stop));
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
          .on_slip = [this] { ++job_.times.slips; },
          .on_frame = [this](const DepthFrame& frame) { show(frame); },
          .on_picture = [this](const Picture& picture) { show(picture); },
          .on_added =
              [this, stop, id = job_.id](const Reconstructor& reconstruction, int snapshots) {
                if (MeshPreview preview = make_preview(id, reconstruction, snapshots, stop);
                    preview.snapshots > 0) {
                  ports_.board.set_mesh_preview(std::move(preview));
                }
              },
          .on_calibrated = [this](const ScanSolution& solution) { keep_calibration(solution); },
          .on_lowered = [this](double bottom) { job_.settings.clip.min.z() = bottom; },
          .on_rebuilt = [this](int snapshots) { show_rebuilt(snapshots); },
          .on_wait = [this] { ports_.heartbeat.beat(); }};
}

void Worker::show_progress(Phase phase, int snapshots_done) {
  const Clock::time_point now = Clock::now();
  const bool is_stop_done = snapshots_done > job_.snapshots_done;
  if (is_stop_done) {
    job_.failure.reset();
    gives_up_.reset();
    job_.times.settling = std::max(job_.times.settling, rig_.settling().time());
  }
  if (is_of_turn(job_.phase) && !is_of_turn(phase)) {
    time_left_->begin_model(now);
  }
  time_left_->count(snapshots_done, now);
  job_.phase = phase;
  job_.snapshots_done = snapshots_done;
  if (is_stop_done && snapshots_done == 1) {
    const std::filesystem::path folder = ports_.store.folder(job_.id);
    const Scan scan = read_scan(folder);
    job_.builds.have_colours = has_colours(folder, scan);
    job_.builds.have_views = !scan.laser;
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
      keep_pose(
          capture_->to_record(report, PoseOrigin::scan, job_.settings, solution.solved.lasers),
          report, OpticsOrigin::scan);
    }
  } catch (...) {
    log::warning("scanner", current_failure().detail);
  }
}

/// Keeps an accepted pose and the optics with which it was solved: later scans of this sensor begin
/// with both. Nothing is kept of a scan that began with other optics than those in force, as one
/// that was paused over a calibration.
void Worker::keep_pose(PoseRecord pose, const CalibrationReport& report, OpticsOrigin origin) {
  const std::string serial = capture_->sensor().serial;
  const bool are_new = report.optics_differ && !serial.empty();
  const auto kept = optics_record(ports_.store.data(), serial);
  if (kept ? !rig_.optics() || !are_alike(kept->optics.value, rig_.optics()->value)
           : rig_.optics().has_value() && !serial.empty()) {
    log::info("calibration", "the pose is the scan's alone: it began with other optics");
    return;
  }
  if (are_new || (kept && rig_.optics())) {
    pose.optics_of = serial;
    pose.optics_at = are_new ? pose.at : kept->at;
  }
  if (!are_new) {
    ports_.calibration.set(pose);
    return;
  }
  OpticsRecord record{.optics = *report.optics, .origin = origin, .at = pose.at};
  record.optics.value.depth_scale = kept ? kept->optics.value.depth_scale : 1;
  introduced_.reset();  // which drops the pose if its optics cannot be written
  ports_.calibration.set(pose, record);
  try {
    remake_sensor_map(ports_.store.data(), serial);
  } catch (...) {
    log::warning("calibration", current_failure().detail);
  }
  introduce_sensor();
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
    const Failure unsaved = current_failure();
    log::error("scanner", unsaved.detail);
    Failure reason = job_.failure.value_or(unsaved);
    reason.hint += " Then resume the scan.";
    job_ = ports_.store.interrupt(job_.id, reason);
  }
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_job(job_);
}

/// Checks that a scan of another pose uses the first scan's sensor: only turns of one sensor are
/// registered.
void Worker::expect_same_sensor() {
  if (!job_.pose_of) {
    return;
  }
  const Scan first = read_scan(ports_.store.folder(job_.pose_of->scan));
  if (!capture_->has_sensor_of(first, job_.settings)) {
    throw Error(ErrorCode::sensor_other,
                "the scan of the first pose was made with another sensor: " + first.sensor_name,
                "Plug in the one that it was made with.", {{"first_pose_with", first.sensor_name}});
  }
}

void Worker::show_join(Phase phase) {
  job_.phase = phase;
  ports_.board.set_job(job_);
  begin(phase);
}

/// Registers a scan of another pose with the turns before it, and builds one model of all of them,
/// which becomes the first scan's. If the registration is refused, that model stays.
/// @return false if stopped first
bool Worker::join(const std::stop_token& stop) try {
  if (!job_.pose_of) {
    return true;
  }
  show_join(Phase::registering);
  ports_.store.withdraw_pose(job_.pose_of->scan, job_.id);  // of an earlier attempt
  const Job first = ports_.store.get(job_.pose_of->scan);
  std::vector<std::string> poses = merged_poses(first, job_.id);
  std::vector<StoredTurn> turns =
      read_turns({ports_.store.merged_scan(first.id, poses), ports_.store.folder(job_.id)});
  poses.push_back(job_.id);
  const Registration registration = register_turns(turns, limits_.threads, stop);
  write_pose_points(ports_.store.folder(job_.id), turns, registration.points);
  job_.pose_of->registration = to_pose_registration(registration);
  log::info("scanner", "scan " + job_.id + " as a pose of " + first.id + ": " +
                           (registration.accepted ? "it fits" : registration.reason));
  return !registration.accepted ||
         keep_merged(first, {.turns = turns, .registration = registration, .poses = poses}, stop);
} catch (const Stopped&) {
  return false;
}

/// Builds the model of all poses and makes it the first scan's. @return false if stopped first
bool Worker::keep_merged(const Job& first, const MergedTurns& merged, const std::stop_token& stop) {
  show_join(Phase::building);
  const int number = ports_.store.next_build(first.id);
  std::optional<Build> build =
      build_merged(ports_.store, first, merged, merged_settings(first, job_), number, limits_, stop,
                   [](Phase, int) {});
  if (!build) {
    ports_.store.drop_build(first.id, number);
    job_.pose_of->registration.reset();
    return false;
  }
  build->created = job_.times.created;
  build->replaced = ports_.store.get(first.id).builds.chosen;  // another may be chosen meanwhile
  ports_.store.add_build(first.id, *build);
  ports_.store.choose_build(first.id, number);
  return true;
}

void Worker::carry_out(BuildCommand& command, const std::stop_source& stop) {
  ports_.heartbeat.suspend();  // a model may take minutes
  BuildRun& run = command.run;
  const std::string name = describe(run);
  run.state = BuildRun::State::running;
  ports_.board.set_build_run(run);
  log::info("scanner", name + " started");
  try {
    run.state = build_and_keep(command, limits_, ports_, stop.get_token())
                    ? BuildRun::State::finished
                    : BuildRun::State::cancelled;
  } catch (...) {
    run.state = BuildRun::State::failed;
    run.failure = current_failure();
    log::error("scanner", name + ": " + run.failure->detail);
  }
  ports_.store.drop_build(run.scan, run.number);
  run.phase = Phase::done;
  const std::lock_guard lock(ports_.scans);
  if (run.state == BuildRun::State::cancelled && ports_.slot.has_scan()) {
    run.failure = displaced_by_scan();
  }
  log::info("scanner", name + " " + std::string(to_string(run.state)));
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_build_run(run);
}

void Worker::carry_out(CalibrateCommand& command, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::turn, .stops = command.settings.snapshots},
            [&](CalibrationRun& run) { measure(run, command.settings, stop.get_token()); });
}

void Worker::carry_out(WallCommand& command, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::wall,
             .phase = CalibrationRun::Phase::looking,
             .stops = command.frames},
            [&](CalibrationRun& run) { measure_wall(run, stop.get_token()); });
}

/// Runs a measurement, and publishes its state.
/// @param measurement  sets its outcome in `run`
void Worker::carry_out(CalibrationRun run,
                       const std::function<void(CalibrationRun& run)>& measurement) {
  ports_.board.drop_waiting_build(displaced_by_scan());  // this command replaced it
  constexpr std::array<const char*, 3> names{"turn", "wall", "lens"};
  const std::string name = names[static_cast<std::size_t>(run.kind)];
  log::info("calibration", name + " started, of=" + std::to_string(run.stops));
  try {
    measurement(run);
    log::info("calibration", name + " " + describe_outcome(run));
  } catch (...) {
    run.failure = current_failure();
    run.state = CalibrationRun::State::failed;
    log::error("calibration", run.failure->detail);
    close_device(*run.failure);
  }
  release_rig();
  const std::lock_guard lock(ports_.scans);
  if (run.lens && run.lens->accepted) {
    ports_.solved_lens =
        SolvedLens{.camera = run.camera, .report = *run.lens, .optics = run.optics};
  }
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_calibration_run(std::move(run));
}

/// Measures a turn, and puts the solved pose into force if it is accepted.
void Worker::measure(CalibrationRun& run, const ScanSettings& settings,
                     const std::stop_token& stop) {
  const ScanObserver observer{
      .on_progress =
          [&](Phase phase, int done) {
            run.stop = done;
            run.phase = phase == Phase::calibrating ? CalibrationRun::Phase::solving
                                                    : CalibrationRun::Phase::turning;
            ports_.board.set_calibration_run(run);
            begin(phase);
          },
      .on_turn = [this](double angle_deg) { save_platform_angle(angle_deg); },
      .on_frame = [this](const DepthFrame& frame) { show(frame); }};
  capture_->use_stored(settings, {});
  run.report = capture_->measure_turn(settings, limits_.threads, stop, observer);
  if (!run.report) {
    run.state = CalibrationRun::State::cancelled;
    return;
  }
  const TurnReport& report = *run.report;
  if (report.calibration.accepted) {
    keep_pose(to_record(report, settings, *capture_), report.calibration, OpticsOrigin::turn);
  }
  run.state =
      report.calibration.accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
}

/// Reads frames of a wall, and stores the sensor's map if it is accepted.
void Worker::measure_wall(CalibrationRun& run, const std::stop_token& stop) {
  ports_.heartbeat.suspend();  // this takes as long as its frames
  DepthSensor& sensor = rig_.sensor();
  const std::string serial = sensor.serial();
  if (serial.empty()) {
    throw Error(
        ErrorCode::bad_settings, sensor.name() + ": reports no serial number",
        "A map belongs to one sensor. Make it of a recording with octurn calibrate --wall.");
  }
  const auto show_wall = [&](const DepthFrame& frame, int frames) {
    run.stop = frames;
    ports_.board.set_calibration_run(run);
    show(frame);
    ports_.heartbeat.suspend();
  };
  const std::filesystem::path data = ports_.store.data();
  const std::optional<WallView> view = look_at_wall(sensor, run.stops, next_wall(data, serial),
                                                    rig_.sensor_on_for(), stop, show_wall);
  if (!view) {
    run.state = CalibrationRun::State::cancelled;
    return;
  }
  run.phase = CalibrationRun::Phase::solving;
  ports_.board.set_calibration_run(run);
  run.wall = add_wall(data, serial, *view);
  run.state = run.wall->accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
  introduced_.reset();
  introduce_sensor();
}

/// Publishes the open sensor's serial number, map and lens, once after each opening.
void Worker::introduce_sensor() {
  const auto since = rig_.sensor_since();
  if (!since || since == introduced_) {
    return;
  }
  introduced_ = since;
  const SensorInfo sensor = capture_->sensor();
  KnownSensor known{.serial = sensor.serial, .since = since, .has_infrared = sensor.has_infrared};
  try {
    ports_.calibration.drop_without_optics(known.serial);
    known.map = find_map_summary(ports_.store.data(), known.serial);
    known.optics = read_optics(ports_.store.data(), known.serial);
    known.lens = octurn::find_lens(ports_.store.data(), known.serial);
  } catch (...) {
    log::warning("calibration", current_failure().detail);
  }
  ports_.devices.update([&](DeviceStates& devices) { devices.serial = known.serial; });
  ports_.board.set_known_sensor(std::move(known));
}

void Worker::carry_out(LensCommand& command, const std::stop_source& stop) {
  carry_out({.kind = CalibrationRun::Kind::lens, .phase = CalibrationRun::Phase::looking},
            [&](CalibrationRun& run) { find_lens(run, command.square, stop.get_token()); });
}

/// Whether a measurement by a board was cancelled; else it is solved from the views so far.
bool Worker::is_board_put_away(CalibrationRun& run, const std::stop_token& stop) const {
  const bool is_cancelled = stop.stop_requested() &&
                            (ports_.slot.scan_stop() != ScanStop::pause || ports_.slot.has_ended());
  if (is_cancelled) {
    run.state = CalibrationRun::State::cancelled;
  }
  return is_cancelled;
}

/// Publishes what a picture of a board showed, and that the worker still lives.
void Worker::report_look(CalibrationRun& run, const BoardLook& look) {
  ports_.heartbeat.suspend();
  if (look.taken > 0) {
    ports_.slot.report_lens_view();
  }
  run.look = look;
  run.stop = look.taken;
  run.stops = look.wanted;
  ports_.board.set_calibration_run(run);
}

/// Takes views of a board until they suffice or `Scanner::solve_lens` is called; solves the lens.
void Worker::find_lens(CalibrationRun& run, double square, const std::stop_token& stop) {
  ports_.heartbeat.suspend();  // this takes as long as somebody holds a board
  run.camera = capture_->sensor().serial;
  const BoardObserver observer{.on_picture =
                                   [&](const Picture& picture, const BoardLook& look) {
                                     show(picture);
                                     report_look(run, look);
                                   },
                               .on_solving =
                                   [&] {
                                     if (is_board_put_away(run, stop)) {
                                       return false;
                                     }
                                     run.phase = CalibrationRun::Phase::solving;
                                     ports_.board.set_calibration_run(run);
                                     return true;
                                   }};
  const auto result = capture_->measure_board(square, stop, observer);
  if (result) {
    run.lens = result->lens;
    run.optics = result->optics;
    run.state = run.lens->accepted ? CalibrationRun::State::done : CalibrationRun::State::refused;
  }
}

/// Returns the folder of the scan whose lens or optics the running one uses: a resumed scan keeps
/// those that it was begun with, and a scan of another pose uses those of the first scan. Empty for
/// a first one.
std::filesystem::path Worker::first_scan() const {
  const std::string id = job_.snapshots_done > 0 ? job_.id : job_.pose_of ? job_.pose_of->scan : "";
  return id.empty() ? std::filesystem::path() : ports_.store.folder(id);
}

}  // namespace octurn
