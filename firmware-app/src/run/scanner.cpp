#include "run/scanner.hpp"

#include <algorithm>
#include <filesystem>
#include <future>
#include <system_error>
#include <utility>

#include "run/worker.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto camera_patience =
    15s;  // a sensor takes 1 to 2 s to its first frame, on a busy machine more
constexpr auto camera_interest = 5s;  // frames are read for that long after someone asked
constexpr auto failure_lasts = 2s;    // maximum age of a failure that is reported again
constexpr auto fresh = 200ms;         // maximum age of a current frame
constexpr auto max_silence = 30s;     // of the worker: ten times the time that a device may take

RigOptions at_angle(RigOptions rig, double angle_deg) {
  rig.platform_angle_deg = angle_deg;
  return rig;
}

}  // namespace

Scanner::Scanner(RigOptions rig, const Limits& limits, ScanStore& store,
                 const std::optional<SlurmOptions>& slurm)
    : store_(store),
      limits_(limits),
      calibration_(store.data(), rig.laser ? SensorKind::laser_line : SensorKind::depth),
      board_(rig) {
  if (slurm) {
    slurm_.emplace(*slurm, store, limits);
  }
  slot_.want_camera(Clock::now() + camera_interest);  // so that the status shows the devices
  worker_ =
      std::jthread([this, limits, rig = at_angle(std::move(rig), store.platform_angle_deg())] {
        Worker(rig, limits,
               {store_, board_, devices_, slot_, heartbeat_, calibration_, scans_, solved_lens_})
            .work();
      });
}

Scanner::~Scanner() { request_stop(); }

void Scanner::request_stop() {
  slot_.end();
  ending_.request_stop();
}

std::optional<Job> Scanner::start(const ScanSettings& settings) {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan()) {
    return std::nullopt;
  }
  const Job job = store_.create(settings);
  return hand_over(job, ScanCommand{job});
}

std::optional<Job> Scanner::resume(std::string_view id) {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan()) {
    return std::nullopt;
  }
  if (slurm_ && slurm_->is_building(id)) {
    expect_idle(id);
  }
  const Job job = store_.update(id, [this](Job& stored) {
    expect_resumable(stored);
    if (stored.state == JobState::cancelled) {
      stored.builds.chosen = 0;  // a build of a part of the turn: the complete model replaces it
    }
    stored.state = JobState::running;
    stored.phase = Phase::starting;
    stored.failure.reset();
  });
  return hand_over(job, ResumeCommand{job});
}

/// @throws Error "not-paused"
void Scanner::expect_resumable(const Job& job) const {
  if (!can_resume(job)) {
    throw Error(ErrorCode::not_paused,
                "this scan is " + std::string(to_string(job.state)) +
                    (job.state == JobState::cancelled ? ", and another one was started since" : ""),
                "Only a scan that was paused or interrupted can be resumed, or the last one if it "
                "was ended.");
  }
}

/// Hands a scan to the worker, which has none; `scans_` is held.
std::optional<Job> Scanner::hand_over(Job job, Command command) {
  board_.begin_scan(job,
                    Clock::now() - std::chrono::duration_cast<Clock::duration>(job.times.elapsed));
  if (!slot_.offer_scan(std::move(command))) {
    board_.set_job(store_.interrupt(job.id));  // this program is ending
    return std::nullopt;
  }
  return job;
}

bool Scanner::can_resume(const Job& job) const {
  const bool is_ended = job.state == JobState::cancelled && !job.model;
  return is_resumable(job.state) || (is_ended && store_.newest_id() == job.id);
}

bool Scanner::pause(std::string_view id) {
  const std::lock_guard lock(scans_);
  if (!slot_.has_scan(id)) {
    return false;
  }
  slot_.stop_scan(ScanStop::pause);
  return true;
}

bool Scanner::cancel(std::string_view id) {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan(id)) {
    slot_.stop_scan(ScanStop::end);
    return true;
  }
  const std::optional<Job> job = store_.find(id);
  if (!job || !is_resumable(job->state)) {
    return false;
  }
  if (job->pose_of) {
    store_.withdraw_pose(job->pose_of->scan, job->id);  // it may be merged already
  }
  bool is_ended = false;
  const Job now = store_.update(id, [&](Job& stored) {
    is_ended = is_resumable(stored.state);  // a build of Slurm may have finished it meanwhile
    if (is_ended) {
      stored.state = JobState::cancelled;
      stored.failure.reset();
    }
  });
  board_.set_job(now);
  return is_ended;
}

void Scanner::label(std::string_view id, const LabelChange& change) {
  store_.label(id, change);
  board_.label(id, change);
}

Job Scanner::find(std::string_view id) const {
  const Job stored = store_.get(id);
  const std::optional<Job> now = running();
  return now && now->id == id ? *now : stored;
}

std::optional<Job> Scanner::running() const {
  const Status now = status();
  if (!now.is_scanning()) {
    return std::nullopt;
  }
  const std::optional<Job> stored = store_.find(now.job->id);
  return stored ? with_stored_changes(*now.job, *stored) : now.job;
}

std::vector<Job> Scanner::list() const {
  std::vector<Job> jobs = store_.list();
  if (const std::optional<Job> now = running()) {
    std::ranges::replace_if(
        jobs, [&](const Job& job) { return job.id == now->id; }, *now);
  }
  return jobs;
}

Status Scanner::wait_until_done(std::chrono::milliseconds patience) const {
  board_.latest_status().wait(ending_.get_token(), patience,
                              [](const Status& status) { return !status.busy(); });
  return status();
}

std::shared_ptr<const CameraFrame> Scanner::camera_frame() {
  const bool scanning = slot_.has_scan();
  const bool rebuilding = !scanning && slot_.is_occupied();
  const Clock::time_point asked = Clock::now();
  slot_.want_camera(asked + camera_interest);
  auto frame = board_.camera_frame().wait(
      ending_.get_token(), camera_patience, [&](const CameraFrame& latest) {
        const auto age = asked - latest.time;
        return rebuilding || (latest.failure ? age < failure_lasts
                                             : age < fresh || (scanning && latest.has_image()));
      });
  if (frame->failure) {
    throw to_error(*frame->failure);
  }
  if (rebuilding && !frame->has_image()) {
    throw Error(ErrorCode::busy, "a model is being made", "Wait for its end.");
  }
  if (!scanning && !rebuilding && asked - frame->time >= fresh) {
    throw Error(ErrorCode::sensor_silent, "the sensor has sent no frame yet",
                "Try again in a moment.");
  }
  return frame;
}

void Scanner::expect_ready() {
  if (slot_.is_occupied()) {
    return;  // the worker cannot check the devices now
  }
  auto now = devices_.get();
  if (!now->sensor_is_ready || !now->turntable_is_ready) {
    camera_frame();  // opens both
    now = devices_.get();
  }
  if (!is_busy() && now->turntable_failure) {
    throw to_error(*now->turntable_failure);
  }
}

bool Scanner::calibrate(const ScanSettings& settings) {
  return begin({.stops = settings.snapshots}, CalibrateCommand{settings});
}

bool Scanner::look_at_wall(int frames) {
  return begin({.kind = CalibrationRun::Kind::wall,
                .phase = CalibrationRun::Phase::looking,
                .stops = frames},
               WallCommand{frames});
}

bool Scanner::begin(CalibrationRun run, Command command) {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan() || slot_.has_ended()) {
    return false;
  }
  solved_lens_.reset();
  board_.set_calibration_run(run);
  if (!slot_.offer_scan(std::move(command))) {
    run.state = CalibrationRun::State::cancelled;  // the scanner is ending
    board_.set_calibration_run(std::move(run));
    return false;
  }
  return true;
}

bool Scanner::forget_sensor_map() {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan()) {
    return false;
  }
  const std::string serial = sensor_serial();
  std::error_code unreadable;
  if (serial.empty() ||
      !std::filesystem::exists(sensor_map_path(store_.data(), serial), unreadable)) {
    throw Error(ErrorCode::not_found, "this sensor has no map", "There is nothing to remove.");
  }
  remove_sensor_map(store_.data(), serial);
  board_.clear_sensor_map();
  return true;
}

bool Scanner::cancel_calibration() {
  const std::lock_guard lock(scans_);
  if (!slot_.has_measurement()) {
    return false;
  }
  slot_.stop_scan(ScanStop::end);
  return true;
}

bool Scanner::check_devices(std::function<void(Rig& rig, const std::stop_token& stop)> check) {
  DeviceCheckCommand command{
      .check = std::packaged_task<void(Rig&, const std::stop_token&)>(std::move(check))};
  std::future<void> done = command.check.get_future();
  if (!slot_.offer_check(std::move(command))) {
    return false;
  }
  try {
    done.get();
    return true;
  } catch (const std::future_error&) {
    return false;  // a scan replaced the command
  }
}

bool Scanner::is_alive() const { return heartbeat_.is_alive(max_silence); }

}  // namespace octurn
