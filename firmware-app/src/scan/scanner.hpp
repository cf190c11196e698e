#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>
#include <vector>

#include "scan/calibration_store.hpp"
#include "scan/command_slot.hpp"
#include "scan/heartbeat.hpp"
#include "scan/scan_store.hpp"
#include "scan/slurm_builds.hpp"
#include "scan/status_board.hpp"

namespace octurn {

/// Runs one scan at a time on its own worker thread. Thread-safe.
///
///              start                  every snapshot taken, and the model built
///     (none) --------> running ------------------------------------------------> finished
///                      |  ^  |  disk full, nothing in the clip box, ... --------> failed
///  pause, or a device  |  |  |  cancel ----------------------------------------> cancelled
///  fails, also when    |  |  |                                                    |  ^
///  tried again: paused<+  |  +-> interrupted, when this program ends or the       |  |
///                 |       |            |      outcome cannot be saved             |  |
///                 +-------+------------+---- resume; or cancel -------------------|--+
///                         +---- resume, unless another scan was started ----------+
///
/// Who owns what:
///
///     any thread --- Scanner --- CommandSlot (one waits, one is carried out) --> Worker
///                       |                                                          |
///                       |   stores: scans and poses on the disk, held in memory    |  the rig,
///                       +-- StatusBoard: status, camera frame, mesh preview <------+  the volume,
///                       +-- ModelPipe: the bytes of a model <----------------------+  the scan
class Scanner {
 public:
  /// @param slurm  builds the models of stored scans; nothing: the worker builds them
  Scanner(RigOptions rig, const Limits& limits, ScanStore& store,
          const std::optional<SlurmOptions>& slurm = {});
  ~Scanner();
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Starts a scan, unless one runs: nothing then.
  /// @throws Error "disk-full", "data-failed"
  std::optional<Job> start(const ScanSettings& settings);

  /// Starts a scan of the object of a finished scan in another pose, after a person turned it over.
  /// Both are merged, and the model of all poses becomes that of the finished scan. Nothing if a
  /// scan runs.
  /// @param id  of the finished scan
  /// @throws Error "no-such-scan", "no-model"  if it is not finished, or is itself of another pose;
  ///               "disk-full", "data-failed"
  std::optional<Job> start_pose(std::string_view id, const ScanSettings& settings);

  /// The scans of other poses of that scan as they are now, the oldest first.
  std::vector<Job> poses(std::string_view id) const;

  /// One of these scans, as stored.
  /// @param number  from 1
  /// @throws Error "no-such-scan", "not-found"  if there is no such pose
  Job find_pose(std::string_view id, int number) const;

  /// Removes a pose: its scan is deleted, and the model before it is restored.
  /// @param number  of the pose, from 1
  /// @throws Error "no-such-scan", "not-found"  if there is no such pose; "busy"  if it is being
  ///               scanned, or a later one was merged with it
  void remove_pose(std::string_view id, int number);

  /// Has the worker register a scan of another pose again, from a person's estimate, and build the
  /// model of all poses again. It is a build, and fails if the estimate does not fit.
  /// @param number  of the pose, from 1
  /// @return nothing while a scan runs or a build goes on
  /// @throws Error  as `remove_pose` and `build`
  std::optional<BuildRun> choose_pose(std::string_view id, int number, const PoseChoice& choice);

  /// Continues a paused or interrupted scan at the stop where it ended. Nothing if a scan runs. A
  /// cancelled scan can be resumed, too, until another one is started: its object may still be on
  /// the platform.
  /// @throws Error "no-such-scan", "not-paused", "disk-full", "write-failed"
  std::optional<Job> resume(std::string_view id);

  /// Whether `resume` takes that scan.
  bool can_resume(const Job& job) const;

  /// Asks the scan of that id to stop, so that it is paused.
  /// @return false if it does not run
  bool pause(std::string_view id);

  /// Asks the scan of that id to stop, or ends it if it is paused or interrupted.
  /// @return false if it has ended already
  bool cancel(std::string_view id);

  /// Moves a scan that does not run into the bin, with its other poses. A scan of another pose is
  /// removed from its scan.
  /// @throws Error "no-such-scan", "busy"
  void remove(std::string_view id);

  /// Imports a scan of another Octurn, and has its model built unless a scan runs.
  /// @param fill   fills a folder with a whole scan folder; its exceptions are passed on
  /// @param bytes  maximum size of that folder
  /// @throws Error "disk-full", "data-failed"
  Job adopt(const std::function<void(const std::filesystem::path& folder)>& fill,
            std::uint64_t bytes);

  /// Brings a scan back from the bin. @throws Error "no-such-scan"
  void restore(std::string_view id);

  /// Removes the scans in the bin permanently.
  void empty_bin() { store_.empty_bin(); }

  /// @throws Error "no-such-scan"
  void label(std::string_view id, const LabelChange& change);

  /// The scan of that id as it is now. @throws Error "no-such-scan"
  Job find(std::string_view id) const;

  /// All scans as they are now, the newest first.
  std::vector<Job> list() const;

  Status status() const { return board_.status(); }

  /// The same without the times of a running scan; the same object until a scan changes.
  std::shared_ptr<const Status> latest_status() const { return board_.latest_status().get(); }

  /// Waits until no scan and no measurement runs, for at most `patience`.
  Status wait_until_done(std::chrono::milliseconds patience) const;

  /// The current depth image; during a scan or while a model is made, the last one.
  /// @throws Error  if there is none, with the reason
  std::shared_ptr<const CameraFrame> camera_frame();

  /// Checks whether a device that failed works again, unless a scan runs.
  /// @throws Error "sensor-...", "turntable-..."  if it does not
  void expect_ready();

  /// Measures the sensor's pose with a turn, and puts it into force if it is accepted.
  /// @param settings  with the pose in force; `snapshots` are the stops
  /// @return false if a scan or another measurement runs
  bool calibrate(const ScanSettings& settings);

  /// Reads depth frames of a wall, and fits the sensor's map to this and the earlier views.
  /// @return false if a scan or another measurement runs
  bool look_at_wall(int frames);

  /// Takes pictures of a board that somebody holds before the camera, and solves its lens. The
  /// result is in the run; `keep_lens` puts it into force.
  /// @return false if a scan or another measurement runs
  bool look_at_board();

  /// Has the lens solved from the views of the board so far. @return false if none are taken
  bool solve_lens();

  /// Keeps the lens that was found last, or forgets it: the run is over then.
  /// @throws Error "not-found"  if none was found
  void keep_lens();
  void discard_lens();

  /// Removes the kept lens of the camera that was opened last: the settings' holds again.
  /// @throws Error "not-found"  if there is none; "write-failed"
  void forget_lens();

  /// Removes the map of the sensor that was opened last, and the looks that it was made of.
  /// @return false if a scan, or a measurement, goes on
  /// @throws Error "not-found"  if it has none; "write-failed"
  bool forget_sensor_map();

  /// The sensor that is open, or was last.
  std::shared_ptr<const KnownSensor> known_sensor() const { return board_.known_sensor().get(); }

  /// Asks the turn, or the look, to stop. @return false if none goes on
  bool cancel_calibration();

  /// The measurement that goes on, or the last one.
  std::shared_ptr<const std::optional<CalibrationRun>> calibration_run() const {
    return board_.calibration_run().get();
  }

  /// The poses of the sensor.
  CalibrationStore& calibration() { return calibration_; }
  const CalibrationStore& calibration() const { return calibration_; }

  std::shared_ptr<const MeshPreview> mesh_preview() const { return board_.mesh_preview().get(); }

  /// Has the worker, or Slurm, build a model from a stored scan and keep it. A scan that starts
  /// ends what the worker builds.
  /// @return nothing while the worker has a scan or another build
  /// @throws Error "no-such-scan", "busy"  if the scan has not ended, "no-model"  if it has no
  /// snapshots, "disk-full"
  std::optional<BuildRun> build(std::string_view id, const BuildOrder& order);

  /// Asks a build to stop. @return false if it has ended already
  bool cancel_build(std::string_view id, int number);

  /// The build that the worker has, or had last.
  std::shared_ptr<const std::optional<BuildRun>> build_run() const {
    return board_.build_run().get();
  }

  /// The builds that Slurm has, and those that it had of which no model came; null without Slurm.
  std::shared_ptr<const std::vector<BuildRun>> slurm_runs() const {
    return slurm_ ? slurm_->runs().get() : nullptr;
  }

  /// All of them.
  std::vector<BuildRun> build_runs() const;

  /// Makes the model of a build the scan's. @throws  as `ScanStore::choose_build`
  void choose_build(std::string_view id, int number) { store_.choose_build(id, number); }

  /// Removes a build. @throws  as `ScanStore::remove_build`, "busy"  also if it belongs to a pose
  void remove_build(std::string_view id, int number);

  /// Has the worker make the model of a stored scan with other options. There is one at a time, as
  /// memory is for one; another one is waited for. A scan that starts ends it.
  /// @param options  but for the clip box, which is the scan's
  /// @return nothing while a scan or a build goes on, or another model is made for too long
  /// @throws Error  if the scan cannot be read, the model is empty or does not fit into memory
  std::unique_ptr<ModelStream> stream_model(std::string_view id, const ReconstructOptions& options);

  /// Has the worker make the colours of a model, and waits for them. As above there is one such
  /// thing at a time, and a scan that starts ends it.
  /// @param build  that the model is of; 0: what the scan itself made
  /// @return false while a scan or a build goes on, or something else is made for too long
  /// @throws Error  as `octurn::colour_model` and `scan_of_model`; "busy"  if a scan starts
  /// meanwhile
  bool colour_model(const Job& job, int build);

  /// Has the worker use the rig, between scans, and waits until it has. A scan that starts asks for
  /// it back.
  /// @param check  returns soon after its token has a stop request; what it throws comes out here
  /// @return false if it was not called, since a scan runs, a model is made, or this ends
  bool check_devices(std::function<void(Rig& rig, const std::stop_token& stop)> check);

  /// Whether the worker still works: told without any of its locks, nor the disk.
  bool is_alive() const;

  /// Asks the worker to end. The destructor does the same, and waits for it.
  void request_stop();

 private:
  bool is_running(std::string_view id) const;
  bool is_building(std::string_view id) const;
  void expect_idle(std::string_view id) const;
  void expect_last_pose(const Job& pose) const;
  CalibrationRun found_lens() const;
  void take_back(const Job& pose);
  std::optional<BuildRun> offer_build(BuildCommand command);
  std::optional<Job> hand_over(Job job, Command command);
  bool begin(CalibrationRun run, Command command);
  std::unique_ptr<ModelStream> make_for_request(std::function<void(ModelPipe& pipe)> make);

  ScanStore& store_;
  Limits limits_;
  CalibrationStore calibration_;
  StatusBoard board_;
  CommandSlot slot_;
  Heartbeat heartbeat_;
  std::stop_source ending_;
  std::optional<SlurmBuilds> slurm_ = {};
  std::mutex scans_;     // held while it is decided what becomes of a scan
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
