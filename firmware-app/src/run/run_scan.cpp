#include "run/run_scan.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "build/early_model.hpp"
#include "capture/last_look.hpp"
#include "capture/line_preview.hpp"
#include "capture/plan.hpp"
#include "capture/scan_of_rig.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/quality.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "store/stored_scan.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto wait_interval = std::chrono::milliseconds(500);

/// Rounds an angle as scan.json does, in degrees: a later build from the folder has the same bytes.
double stored_angle(double angle) { return radians_from_degrees(degrees_from_radians(angle)); }

/// One attempt at a scan, from its next stop to its model.
class Run {
 public:
  Run(const ScanSettings& settings, const Limits& limits, const std::filesystem::path& folder,
      Capture& capture, const std::stop_token& stop, const ScanObserver& observer)
      : settings_(settings),
        folder_(folder),
        capture_(capture),
        stop_(stop),
        observer_(observer),
        scan_(std::filesystem::exists(folder / "scan.json") ? read_scan(folder)
                                                            : capture.plan(settings)),
        reconstruction_(options_of_scan(scan_, settings, limits)),
        check_({}, reconstruction_.options().clip, static_cast<std::size_t>(settings.snapshots),
               sensor_traits(scan_)),
        preview_solves_(settings.snapshots) {}

  bool has_all_snapshots() const { return done() == settings_.snapshots; }
  /// @return false if stopped first
  bool take_snapshots();
  std::vector<CalibrationFinding> calibrate();
  std::optional<Model> build(Clock::time_point captured,
                             const std::vector<CalibrationFinding>& findings);

 private:
  int done() const { return static_cast<int>(scan_.shots.size()); }
  std::optional<ModelReport> write();
  void add_taken(DepthFrame frame, double angle);
  void resume();
  Scan shown(Scan scan) const;
  SnapshotSource checked();
  void solve_for_preview(const Scan& so_far);
  void add_stored();
  void rebuild();
  bool lower_space();
  template <typename Tell>
  bool wait_for_added(Tell tell);
  template <typename Add>
  void add(Add add_to);

  const ScanSettings& settings_;
  const std::filesystem::path& folder_;
  Capture& capture_;
  const std::stop_token& stop_;
  const ScanObserver& observer_;
  Scan scan_;
  FittingReconstruction reconstruction_;
  PoseChecks check_;  // of the snapshots added to the reconstruction
  int added_ = 0;     // snapshots added to the reconstruction
  PreviewSolves preview_solves_;
  std::optional<SolvedPose> preview_pose_;  // until `calibrate`, in place of the configured one
  std::future<void> adding_;  // at most one: joined before the next begins, and on every way out
  EarlyModel early_;          // with the configured pose, while another is solved
  std::optional<SolvedOptics> seen_optics_;  // as the calibration measured them, applied or not
};

bool Run::take_snapshots() {
  Rig& rig = capture_.rig();
  rig.seen_stop() = {};  // of an earlier scan, maybe of another object
  const int steps = rig.turntable().steps_per_turn();
  const OtherCores than_that_of_the_pulses;
  if (done() == 0) {
    std::error_code ignored;  // if the folder cannot be made, the first image says why
    std::filesystem::create_directories(folder_, ignored);
    capture_.begin(scan_, settings_, folder_);
  } else {
    resume();
  }
  LinePreview preview(folder_, reconstruction_.options(), settings_.snapshots, stop_, observer_);
  for (const std::int64_t position :
       stop_positions(rig.turntable().position(), steps, settings_.snapshots, done())) {
    const Stop at{.index = done(), .position = position};
    const double angle = radians_from_degrees(angle_deg_at(position, steps));
    std::optional<TakenStop> taken =
        capture_.take(at, angle, settings_, folder_, scan_, stop_, observer_);
    if (!taken) {
      return false;
    }
    observer_.on_progress(Phase::capturing, done());
    if (taken->frame) {
      add_taken(*std::move(taken->frame), angle);
    } else {
      preview.add(scan_);
    }
  }
  return true;
}

void Run::add_taken(DepthFrame frame, double angle) {
  add([frame = std::move(frame), angle = stored_angle(angle), this](const Scan& so_far) {
    const Snapshot added = make_snapshot(frame, shown(so_far), {.angle = angle});
    check_.add(so_far.shots.size() - 1, added);
    (*reconstruction_).add(added, stop_);
  });
}

/// Adds the stored snapshots of a resumed scan, in their order, while the platform turns.
void Run::resume() {
  expect_same_sensor(scan_, settings_, capture_);
  preview_solves_.resume_after(done());
  if (capture_.resume(scan_, checked())) {
    add_stored();
  }
}

void Run::add_stored() {
  add([stored = checked(), this](const Scan&) { (*reconstruction_).add(stored, stop_); });
}

/// The scan with the pose that its preview has.
Scan Run::shown(Scan scan) const {
  scan.solved = preview_pose_ ? preview_pose_ : scan.solved;
  return scan;
}

/// Solves the pose from a part of the turn. With a wrong one, views that disagree carve thin parts
/// away before one's eyes. The model is built again with the pose from the whole turn.
void Run::solve_for_preview(const Scan& so_far) {
  preview_solves_.take(static_cast<int>(so_far.shots.size()));
  const int threads = reconstruction_.options().threads;
  const ScanSolution solution =
      solve_scan(folder_, so_far, readable_snapshots(folder_, so_far, stop_), threads, stop_);
  if (solution.report.accepted) {
    preview_solves_.end();
  }
  if (solution.replaces_told) {
    preview_pose_ = solution.solved;
    reconstruction_.start_again();
    (*reconstruction_).add(readable_snapshots(folder_, shown(so_far), stop_), stop_);
  }
}

/// Solves the sensor's pose from the snapshots. If it replaces the configured one, the
/// reconstruction starts again.
std::vector<CalibrationFinding> Run::calibrate() {
  if (settings_.pose == PoseSource::configured || scan_.solved) {
    return {};
  }
  observer_.on_progress(Phase::calibrating, done());
  if (added_ == done() && wait_for_added([] {}) && !preview_pose_ && !stop_.stop_requested()) {
    early_.begin(*reconstruction_, readable_snapshots(folder_, scan_, stop_), folder_ / "Scan.stl");
  }
  const ScanSolution solution =
      solve_scan(folder_, scan_, readable_snapshots(folder_, scan_, stop_),
                 reconstruction_.options().threads, stop_);
  throw_if_stopped(stop_);
  observer_.on_calibrated(solution);
  seen_optics_ = solution.report.optics;
  if (take_solution(scan_, solution)) {
    early_.give_up();
    write_solved_pose(folder_, *scan_.solved, solution.report.slipped);
  }
  if (std::exchange(preview_pose_, {}) || solution.replaces_told) {
    reconstruction_.start_again();
    added_ = 0;
  }
  return solution.report.findings;
}

SnapshotSource Run::checked() {
  return checked_snapshots(readable_snapshots(folder_, shown(scan_), stop_), check_);
}

/// Adds all stored snapshots again, with the pose of `scan_`.
void Run::rebuild() {
  observer_.on_progress(Phase::rebuilding, done());
  const auto read = std::make_shared<std::atomic<int>>(0);
  const SnapshotSource counted{.count = scan_.shots.size(),
                               .read = [read, stored = checked()](std::size_t shot) {
                                 ++*read;
                                 return stored.read(shot);
                               }};
  do {
    *read = 0;
    add([counted, this](const Scan&) { (*reconstruction_).add(counted, stop_); });
  } while (!wait_for_added([&] { observer_.on_rebuilt(std::min(read->load(), done())); }));
  observer_.on_rebuilt(done());
}

/// Lowers the space to the end of the platform's noise, if the object is mostly below it and nobody
/// chose where it begins. The model then has to be built again.
bool Run::lower_space() {
  const bool is_chosen = reconstruction_.options().clip.min.z() != ScanSettings{}.clip.min.z();
  const auto bottom = is_chosen ? std::nullopt : check_.lower_bottom();
  if (!bottom) {
    return false;
  }
  early_.give_up();
  scan_.clip.min.z() = *bottom;
  write_clip(folder_, scan_.clip);
  observer_.on_lowered(*bottom);
  reconstruction_.start_again(scan_.clip);
  check_ = PoseChecks({}, scan_.clip, scan_.shots.size(), sensor_traits(scan_));
  added_ = 0;
  return true;
}

/// @param tell  called every `wait_interval`
/// @return false if memory was exceeded: the reconstruction is then coarser, and empty
template <typename Tell>
bool Run::wait_for_added(Tell tell) {
  while (adding_.valid() && adding_.wait_for(wait_interval) != std::future_status::ready) {
    tell();
  }
  try {
    if (adding_.valid()) {
      adding_.get();
    }
    return true;
  } catch (const Error& error) {
    reconstruction_.make_coarser(error);
    added_ = 0;
    return false;
  }
}

/// @param add_to  adds to the reconstruction on a thread of its own; called with the scan so far
template <typename Add>
void Run::add(Add add_to) {
  if (!wait_for_added([this] { observer_.on_wait(); })) {
    add_stored();  // including the new snapshot
    return;
  }
  added_ = done();
  const bool is_preview = done() < settings_.snapshots;  // else the model follows
  const bool solves =
      preview_solves_.are_due(done()) && !scan_.solved && settings_.pose != PoseSource::configured;
  adding_ = std::async(std::launch::async, [=, so_far = scan_, this, add = std::move(add_to)] {
    add(so_far);
    if (solves) {
      solve_for_preview(so_far);
    }
    if (is_preview && !stop_.stop_requested()) {
      observer_.on_added(*reconstruction_, static_cast<int>(so_far.shots.size()));
    }
  });
}

/// Adds missing snapshots and writes the model; makes it coarser while it exceeds the memory.
/// @return nullopt if stopped first
std::optional<ModelReport> Run::write() {
  for (;;) {
    if (added_ < done()) {
      rebuild();
    }
    observer_.on_progress(Phase::building, done());
    if (!wait_for_added([] {})) {
      continue;
    }
    if (stop_.stop_requested()) {
      return std::nullopt;  // not all snapshots were added
    }
    if (lower_space()) {
      continue;
    }
    try {
      return early_.has_begun()
                 ? early_.finish(stop_)
                 : write_model(*reconstruction_, readable_snapshots(folder_, scan_, stop_),
                               folder_ / "Scan.stl", stop_);
    } catch (const Error& error) {
      expect_higher_object(error, check_);
      reconstruction_.make_coarser(error);
      added_ = 0;
    }
  }
}

/// Writes the model and rates it. Where the volume does not fit into memory as a whole, the
/// snapshots are read again for each part.
/// @param captured  when the last snapshot was stored
/// @param findings  of the calibration
std::optional<Model> Run::build(Clock::time_point captured,
                                const std::vector<CalibrationFinding>& findings) {
  std::optional<ModelReport> report = write();
  if (!report) {
    return std::nullopt;
  }
  Quality quality =
      judge(check_, reconstruction_.options().threads, scan_, *report, findings, seen_optics_);
  reconstruction_.add_coarser_reason(quality);
  report->places = {};  // dropped: every request for a job's state copies it
  return Model{.report = *std::move(report),
               .build_time = Clock::now() - captured,
               .quality = std::move(quality)};
}

}  // namespace

std::optional<Model> run_scan(const ScanSettings& settings, const Limits& limits,
                              const std::filesystem::path& folder, Capture& capture,
                              const std::stop_token& stop, const ScanObserver& observer) try {
  Run run(settings, limits, folder, capture, stop, observer);
  const bool is_unfinished = !run.has_all_snapshots();
  if (is_unfinished && !run.take_snapshots()) {
    return std::nullopt;
  }
  const auto retaken =
      is_unfinished ? capture.look_again(settings, stop, observer) : std::optional<DepthFrame>();
  const Clock::time_point captured = Clock::now();
  std::vector<CalibrationFinding> findings = run.calibrate();
  if (retaken) {
    store_object_motion(folder, *retaken);
  }
  add_stored_move(folder, findings);
  return run.build(captured, findings);
} catch (const Stopped&) {
  return std::nullopt;  // while snapshots were added, or the model was made
}

}  // namespace octurn
