#include "run/scanner.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <mutex>
#include <string>
#include <system_error>
#include <utility>

#include "build/build_model.hpp"
#include "build/colour_model.hpp"
#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "capture/wall_views.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "run/command_slot.hpp"
#include "run/worker.hpp"
#include "store/builds.hpp"
#include "store/data_folder.hpp"
#include "store/scan_archive.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

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

/// Whether a build merged a later pose with that one.
bool is_built_on(const Job& first, const std::string& pose) {
  return std::ranges::any_of(first.builds.all, [&](const Build& build) {
    return has_pose(build, pose) && build.poses.back() != pose;
  });
}

constexpr auto model_patience = std::chrono::seconds(5);  // maximum wait for another request

/// Whether a scan has all its snapshots, but no model yet.
bool waits_for_model(const Job& job) {
  return job.state == JobState::interrupted && job.snapshots_done == job.settings.snapshots;
}

constexpr std::uint64_t import_factor = 3;  // the archive, its files, and their model

std::mutex checking;  // one archive at a time: a check takes up to 100 MB of memory

/// Checks that there is room for a part of an import. The bin's scans stay: what is in an archive
/// is known when all of it is unpacked, and one that is refused must have removed nothing.
/// @throws Error "disk-full"
void expect_import_room(const ScanStore& store, std::uint64_t bytes) {
  expect_room(store.data(), store.free_bytes(), bytes, "a scan from a file");
}

/// Receives an archive, checks it, and adds its scan to the store.
Job take_archive(ScanStore& store, const ArchiveSource& archive, const fs::path& folder,
                 const std::stop_token& stop) {
  const fs::path file = folder / ".scan.zip";
  receive_archive(
      archive, file, [&](std::uint64_t bytes) { expect_import_room(store, bytes); }, stop);
  const std::lock_guard lock(checking);
  throw_if_stopped(stop);
  const auto unpack = [&] {
    check_archive_files(file);
    expect_import_room(store, (import_factor - 1) * archive.bytes);
    read_scan_archive(file, folder, stop);
  };
  std::async(std::launch::async, unpack).get();  // on a larger stack than a server thread's
  std::error_code ignored;
  fs::remove(file, ignored);
  return store.adopt(folder);
}

void remove_import(const fs::path& folder) {
  std::error_code ignored;  // the next start removes leftovers
  fs::remove_all(folder, ignored);
}

}  // namespace

Scanner::Scanner(RigOptions rig, const Limits& limits, ScanStore& store,
                 const std::optional<SlurmOptions>& slurm)
    : store_(store), limits_(limits), calibration_(store.data(), rig.kind()), board_(rig) {
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

std::optional<Job> Scanner::start(const ScanSettings& settings, const LabelChange& label) {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan()) {
    return std::nullopt;
  }
  const Job job = store_.create(settings, {}, label);
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
    board_.set_job(store_.interrupt(job.id, interruption()));  // this program is ending
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

bool Scanner::undo_optics() {
  const std::lock_guard lock(scans_);
  if (slot_.has_scan()) {
    return false;
  }
  const std::string serial = sensor_serial();
  octurn::undo_optics(store_.data(), serial);
  calibration_.drop_without_optics(serial);
  remake_sensor_map(store_.data(), serial);
  board_.set_optics(read_optics(store_.data(), serial), find_map_summary(store_.data(), serial));
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

std::optional<Job> Scanner::start_pose(std::string_view id, const ScanSettings& settings) {
  const std::lock_guard lock(scans_);
  const Job first = store_.get(id);
  if (first.pose_of) {
    throw Error(ErrorCode::no_model, "this scan is itself another pose of " + first.pose_of->scan,
                "Add the pose to that one.");
  }
  if (first.state != JobState::finished) {
    throw Error(ErrorCode::no_model, "this scan is " + std::string(to_string(first.state)),
                "Only a finished one gets another pose.");
  }
  if (slot_.has_scan()) {
    return std::nullopt;
  }
  const Job job = store_.create(settings, PoseOf{.scan = first.id});
  return hand_over(job, ScanCommand{job});
}

std::vector<Job> Scanner::poses(std::string_view id) const {
  std::vector<Job> poses = store_.poses(id);
  if (const std::optional<Job> now = running()) {
    std::ranges::replace_if(
        poses, [&](const Job& pose) { return pose.id == now->id; }, *now);
  }
  return poses;
}

Job Scanner::find_pose(std::string_view id, int number) const {
  store_.get(id);  // throws if there is no such scan
  const std::vector<Job> poses = store_.poses(id);
  if (number < 1 || number > static_cast<int>(poses.size())) {
    throw Error(ErrorCode::not_found, "this scan has no other pose " + std::to_string(number),
                "GET /api/v1/scans/ID/poses lists its poses.");
  }
  return poses[static_cast<std::size_t>(number) - 1];
}

void Scanner::expect_last_pose(const Job& pose) const {
  if (is_built_on(store_.get(pose.pose_of->scan), pose.id)) {
    throw Error(ErrorCode::busy, "a later pose was merged with this one",
                "Take the last pose back first.");
  }
}

std::optional<BuildRun> Scanner::choose_pose(std::string_view id, int number,
                                             const PoseChoice& choice) {
  const std::lock_guard lock(scans_);
  const Job pose = find_pose(id, number);
  expect_idle(pose.id);
  if (pose.state != JobState::finished) {
    throw Error(ErrorCode::no_model, "this pose is " + std::string(to_string(pose.state)),
                "Only one that was scanned can be joined.");
  }
  expect_last_pose(pose);
  const Job first = store_.get(id);
  int snapshots = first.snapshots_done + pose.snapshots_done;
  for (const std::string& other : merged_poses(first, pose.id)) {
    snapshots += store_.get(other).snapshots_done;
  }
  return offer_build(
      {.run = {.scan = first.id, .snapshots = snapshots, .settings = merged_settings(first, pose)},
       .becomes_model = true,
       .pose = choice});
}

void Scanner::remove_pose(std::string_view id, int number) {
  const std::lock_guard lock(scans_);
  remove_pose(find_pose(id, number));
}

/// `scans_` is held.
void Scanner::remove_pose(const Job& pose) {
  expect_idle(pose.id);
  expect_not_building(pose.pose_of->scan);
  expect_last_pose(pose);
  store_.discard_pose(pose.id);
}

void Scanner::remove_build(std::string_view id, int number) {
  std::error_code unreadable;
  const auto folder = store_.model_file(id, number).parent_path();
  if (number > 0 && std::filesystem::exists(folder / merged_folder, unreadable)) {
    throw Error(ErrorCode::busy, "this model belongs to a pose of the scan",
                "It goes with the pose.");
  }
  store_.remove_build(id, number);
}

std::optional<BuildRun> Scanner::build(std::string_view id, const BuildOrder& order) {
  const std::lock_guard lock(scans_);
  const Job job = store_.get(id);
  if (job.state == JobState::running ||
      (is_resumable(job.state) && !(slurm_ && waits_for_model(job)))) {
    throw Error(ErrorCode::busy, "this scan has not ended", "Wait for its end, or end it.");
  }
  if (job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  BuildRun run{.scan = job.id, .snapshots = job.snapshots_done, .settings = order.settings};
  return slurm_ ? slurm_->add(std::move(run), order.becomes_model)
                : offer_build({.run = std::move(run), .becomes_model = order.becomes_model});
}

/// `scans_` is held.
std::optional<BuildRun> Scanner::offer_build(BuildCommand command) {
  if (slot_.is_busy() || slot_.has_ended()) {
    return std::nullopt;
  }
  store_.make_room(max_model_bytes(), "a model");  // last, as it may take the bin's
  BuildRun& run = command.run;
  run.number = store_.next_build(run.scan);
  run.created = utc_text(std::chrono::system_clock::now(), rfc3339);
  board_.set_build_run(run);
  if (!slot_.offer_build(command)) {
    board_.drop_waiting_build({});  // the scanner is ending
    return std::nullopt;
  }
  return run;
}

bool Scanner::cancel_build(std::string_view id, int number) {
  if (slurm_ && slurm_->cancel(id, number)) {
    return true;
  }
  const std::lock_guard lock(scans_);
  if (!slot_.has_build(id, number)) {
    return false;
  }
  if (slot_.stop_build()) {
    board_.drop_waiting_build({});
  }
  return true;
}

bool Scanner::is_building(std::string_view id) const {
  return slot_.has_build(id) || (slurm_ && slurm_->is_building(id));
}

std::vector<BuildRun> Scanner::build_runs() const {
  std::vector<BuildRun> runs;
  if (const auto run = build_run(); *run) {
    runs.push_back(**run);
  }
  if (const auto elsewhere = slurm_runs()) {
    runs.insert(runs.end(), elsewhere->begin(), elsewhere->end());
  }
  return runs;
}

std::unique_ptr<ModelStream> Scanner::stream_model(std::string_view id,
                                                   const ReconstructOptions& options) {
  return make_for_request([folder = store_.folder(id), options](ModelPipe& pipe) {
    make_model(folder, options, pipe);
  });
}

bool Scanner::colour_model(const Job& job, int build, Colours shown) {
  const auto make = [job, build, shown, this](ModelPipe& pipe) {
    octurn::colour_model(store_.model_file(job.id, build), scan_of_model(store_, job, build), shown,
                         limits_.memory_bytes, pipe.stop().get_token());
    pipe.set_length(0);
    pipe.close();
  };
  return make_for_request(make) != nullptr;
}

/// @return null while a scan or a build runs, or if another request takes too long
/// @throws Error  that `make` throws before it sets the pipe's length
std::unique_ptr<ModelStream> Scanner::make_for_request(std::function<void(ModelPipe& pipe)> make) {
  const auto pipe = std::make_shared<ModelPipe>();
  return slot_.offer_rebuild({.make = std::move(make), .pipe = pipe}, pipe->stop(), model_patience)
             ? std::make_unique<ModelStream>(pipe)
             : nullptr;
}

void Scanner::remove(std::string_view id) {
  const std::lock_guard lock(scans_);
  const Job job = store_.get(id);
  if (job.pose_of && store_.find(job.pose_of->scan)) {
    remove_pose(job);
    return;
  }
  const std::vector<Job> poses = store_.poses(id);
  for (const Job& pose : poses) {
    expect_idle(pose.id);
  }
  expect_idle(id);
  store_.discard(id);
}

void Scanner::restore(std::string_view id) {
  const std::lock_guard lock(scans_);
  const auto scan = store_.bin().find(id);
  if (scan && scan->job.pose_of) {
    expect_not_building(scan->job.pose_of->scan);
  }
  store_.restore(id);
}

/// Checks that a scan neither runs nor is being built. @throws Error "busy"
void Scanner::expect_idle(std::string_view id) const {
  if (slot_.has_scan(id)) {
    throw Error(ErrorCode::busy, "this scan is running", "Cancel it first.");
  }
  expect_not_building(id);
}

/// @throws Error "busy"  if a model of the scan is being built
void Scanner::expect_not_building(std::string_view id) const {
  if (is_building(id)) {
    throw Error(ErrorCode::busy, "a model of this scan is being built", "Cancel that first.");
  }
}

Job Scanner::adopt(const ArchiveSource& archive) {
  expect_import_room(store_, import_factor * archive.bytes);
  const std::filesystem::path folder = store_.begin_import();
  Job job;
  try {
    job = take_archive(store_, archive, folder, ending_.get_token());
  } catch (const Stopped&) {
    remove_import(folder);
    throw Error(ErrorCode::busy, "Octurn is ending", "Send the file again when it is back.");
  } catch (...) {
    remove_import(folder);
    throw;
  }
  if (!slurm_) {
    return resume(job.id).value_or(job);
  }
  try {
    build(job.id, {.settings = {.scan = job.settings}, .becomes_model = true});
  } catch (const Error& error) {  // the scan is imported, and can be built later
    log::warning("scanner", "scan " + job.id + " is not built: " + error.what());
  }
  return job;
}

bool Scanner::look_at_board(double square) {
  return begin({.kind = CalibrationRun::Kind::lens, .phase = CalibrationRun::Phase::looking},
               LensCommand{square});
}

bool Scanner::solve_lens() {
  const std::lock_guard lock(scans_);
  return slot_.solve_lens();
}

/// Checks that a lens waits to be kept; `scans_` is held. @throws Error "not-found"
void Scanner::expect_solved_lens() const {
  if (!solved_lens_) {
    throw Error(ErrorCode::not_found, "no lens was found that could be kept",
                "POST /api/v1/calibration with the kind \"lens\" looks for one.");
  }
}

/// Puts a depth sensor's optics into force.
void Scanner::keep_board_optics(const std::string& serial, const SolvedOptics& optics,
                                const ScanSettings& configured) {
  const OpticsRecord record{.optics = optics,
                            .origin = OpticsOrigin::board,
                            .at = utc_text(std::chrono::system_clock::now(), rfc3339)};
  calibration_.use_optics(serial, record, configured);
  remake_sensor_map(store_.data(), serial);
  if (sensor_serial() == serial) {
    board_.set_optics(read_optics(store_.data(), serial), find_map_summary(store_.data(), serial));
  }
}

void Scanner::keep_lens(const ScanSettings& configured) {
  const std::lock_guard lock(scans_);
  expect_solved_lens();
  if (slot_.has_scan()) {
    throw Error(ErrorCode::busy, "a scan or a measurement uses the lens with which it began",
                "Keep the new one when that has ended.");
  }
  const std::string& camera = solved_lens_->camera;
  if (solved_lens_->optics) {
    keep_board_optics(camera, *solved_lens_->optics, configured);
  } else {
    octurn::keep_lens(store_.data(), camera, solved_lens_->report);
    if (sensor_serial() == camera) {
      board_.set_lens(find_lens(store_.data(), camera));
    }
  }
  solved_lens_.reset();
  board_.forget_calibration_run();
}

void Scanner::discard_lens() {
  const std::lock_guard lock(scans_);
  expect_solved_lens();
  solved_lens_.reset();
  board_.forget_calibration_run();
}

void Scanner::forget_lens() {
  const std::lock_guard lock(scans_);
  const std::string serial = sensor_serial();
  std::error_code unreadable;
  if (serial.empty() || !std::filesystem::exists(lens_path(store_.data(), serial), unreadable)) {
    throw Error(ErrorCode::not_found, "no measured lens of this camera is kept",
                "A camera with lasers has the lens of the settings then. A Kinect has optics: null "
                "as \"optics\" takes the last ones back.");
  }
  remove_lens(store_.data(), serial);
  board_.set_lens(std::nullopt);
}

}  // namespace octurn
