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

#include "build/colour_model.hpp"
#include "calibration/calibration_store.hpp"
#include "calibration/lens_files.hpp"
#include "cluster/slurm_builds.hpp"
#include "latest.hpp"
#include "run/command_slot.hpp"
#include "run/status_board.hpp"
#include "store/scan_archive.hpp"
#include "store/scan_store.hpp"

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
///                       +-- DeviceStates: whether they work <----------------------+  the volume,
///                       +-- StatusBoard: status, camera frame, mesh preview <------+  the scan
///                       +-- ModelPipe: the bytes of a model <----------------------+
///
/// Both decide by the slot, the stores and the device states. The StatusBoard is for display alone.
class Scanner {
 public:
  /// @param slurm  builds the models of stored scans; nullopt: the worker builds them
  Scanner(RigOptions rig, const Limits& limits, ScanStore& store,
          const std::optional<SlurmOptions>& slurm = {});
  ~Scanner();
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Starts a scan. @return nullopt if a scan or a measurement runs
  /// @throws Error "disk-full", "data-failed"
  std::optional<Job> start(const ScanSettings& settings, const LabelChange& label = {});

  /// Starts a scan of the object of a finished scan in another pose, after a person turned it over.
  /// Both are merged, and the model of all poses becomes that of the finished scan.
  /// @param id  of the finished scan
  /// @return nullopt if a scan or a measurement runs
  /// @throws Error "no-such-scan", "no-model"  if it is not finished, or is itself of another pose;
  ///               "disk-full", "data-failed"
  std::optional<Job> start_pose(std::string_view id, const ScanSettings& settings);

  /// Lists the scans of other poses of that scan in their current state, oldest first.
  std::vector<Job> poses(std::string_view id) const;

  /// One of these scans, as stored.
  /// @param number  from 1
  /// @throws Error "no-such-scan", "not-found"  if there is no such pose
  Job find_pose(std::string_view id, int number) const;

  /// Removes a pose: its scan is moved into the bin, and the model chosen before it is restored.
  /// @param number  of the pose, from 1
  /// @throws Error "no-such-scan", "not-found"  if there is no such pose; "busy"  if it is being
  ///               scanned, or a later one was merged with it
  void remove_pose(std::string_view id, int number);

  /// Has the worker register a scan of another pose again, starting at a person's estimate, and
  /// build the model of all poses again. The build fails if the registration is refused.
  /// @param number  of the pose, from 1
  /// @return nullopt while a scan, a measurement or a build runs
  /// @throws Error  as `remove_pose` and `build`
  std::optional<BuildRun> choose_pose(std::string_view id, int number, const PoseChoice& choice);

  /// Continues a paused or interrupted scan at the stop where it ended. The scan that was begun
  /// last can also be resumed after it was cancelled, if it has no model: its object may still be
  /// on the platform.
  /// @return nullopt if a scan or a measurement runs
  /// @throws Error "no-such-scan", "not-paused", "disk-full", "write-failed"
  std::optional<Job> resume(std::string_view id);

  /// Whether `resume` accepts that scan.
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

  /// Imports a scan of another Octurn, and has its model built unless a scan runs. The bin gives
  /// its space only to bytes that have arrived. One archive is checked at a time.
  /// @throws Error "bad-request", "cut-short", "disk-full", "data-failed"; "busy"  if the scanner
  ///               ends meanwhile
  Job adopt(const ArchiveSource& archive);

  /// Moves a scan out of the bin. A pose that was removed from its scan joins it again.
  /// @throws Error "no-such-scan"; "busy"  if a model of the scan that it joins is being built
  void restore(std::string_view id);

  /// Removes the scans in the bin permanently.
  void empty_bin() { store_.empty_bin(); }

  /// @throws Error "no-such-scan"
  void label(std::string_view id, const LabelChange& change);

  /// Returns a scan in its current state. @throws Error "no-such-scan"
  Job find(std::string_view id) const;

  /// Returns the scan that runs, in its current state; nullopt if none does.
  std::optional<Job> running() const;

  /// Lists all scans in their current state, newest first.
  std::vector<Job> list() const;

  Status status() const { return board_.status(); }

  /// The status without the times of a running scan. The pointer is the same until the status
  /// changes.
  std::shared_ptr<const Status> latest_status() const { return board_.latest_status().get(); }

  /// Waits until no scan and no measurement runs, for at most `patience`.
  Status wait_until_done(std::chrono::milliseconds patience) const;

  /// Whether a scan, a measurement or a build of the worker waits or runs.
  bool is_busy() const { return slot_.is_busy(); }

  /// Whether the turntable worked at its last use, so that this program has its lines.
  bool has_turntable() const { return devices_.get()->turntable_is_ready; }

  /// The serial number of the sensor that is open, or was open last; empty: none, or it has none.
  std::string sensor_serial() const { return devices_.get()->serial; }

  /// Returns the current depth image or picture; the last one during a scan or while a model is
  /// made.
  /// @throws Error  if there is none, with the reason
  std::shared_ptr<const CameraFrame> camera_frame();

  /// Checks whether a device that failed works again, unless a scan runs.
  /// @throws Error "sensor-...", "turntable-..."  if it does not
  void expect_ready();

  /// Measures the sensor's pose by a turn, and puts it into force if it is accepted.
  /// @param settings  with the pose in force; `snapshots` is the number of stops
  /// @return false if a scan or another measurement runs
  bool calibrate(const ScanSettings& settings);

  /// Reads depth frames of a wall, and fits the sensor's map to this and the earlier views.
  /// @return false if a scan or another measurement runs
  bool look_at_wall(int frames);

  /// Takes pictures of a board that somebody holds before the camera, and solves the camera's lens,
  /// or a depth sensor's optics. The result is in `calibration_run`; `keep_lens` puts it into
  /// force.
  /// @param square  metres: side of the board's squares, which only a depth sensor's optics need
  /// @return false if a scan or another measurement runs
  bool look_at_board(double square);

  /// Has the lens solved from the views so far. @return false if there are none
  bool solve_lens();

  /// Stores the lens that was solved last, or drops it. Both clear `calibration_run`.
  /// @param configured  the settings whose pose and depth scale are in force if no other is
  /// @throws Error "not-found"  if no lens was solved; "busy"  if a scan or a measurement runs
  void keep_lens(const ScanSettings& configured);
  void discard_lens();

  /// Removes the stored lens of the camera that was opened last: the settings' lens is used again.
  /// @throws Error "not-found"  if there is none; "write-failed"
  void forget_lens();

  /// Removes the map of the sensor that was opened last, and the wall views that it was fitted to.
  /// @return false if a scan or a measurement runs
  /// @throws Error "not-found"  if it has none; "write-failed"
  bool forget_sensor_map();

  /// Restores the optics before those in force, of the sensor that was opened last, and makes its
  /// map with them.
  /// @return false if a scan or a measurement runs
  /// @throws Error "not-found"  if none are kept; "write-failed"
  bool undo_optics();

  /// The sensor that is open, or was open last, for display.
  std::shared_ptr<const KnownSensor> known_sensor() const { return board_.known_sensor().get(); }

  /// Asks the running measurement to stop. @return false if none runs
  bool cancel_calibration();

  /// The running measurement, or the last one.
  std::shared_ptr<const std::optional<CalibrationRun>> calibration_run() const {
    return board_.calibration_run().get();
  }

  /// The stored poses of the sensor.
  CalibrationStore& calibration() { return calibration_; }
  const CalibrationStore& calibration() const { return calibration_; }

  std::shared_ptr<const MeshPreview> mesh_preview() const { return board_.mesh_preview().get(); }

  /// Has the worker, or Slurm, build a model from a stored scan and keep it. A scan that starts
  /// stops a build of the worker.
  /// @return nullopt while the worker has a scan, a measurement or another build
  /// @throws Error "no-such-scan", "busy"  if the scan has not ended, "no-model"  if it has no
  /// snapshots, "disk-full"
  std::optional<BuildRun> build(std::string_view id, const BuildOrder& order);

  /// Asks a build to stop. @return false if it has ended already
  bool cancel_build(std::string_view id, int number);

  /// The worker's current or last build.
  std::shared_ptr<const std::optional<BuildRun>> build_run() const {
    return board_.build_run().get();
  }

  /// The builds that wait or run on Slurm, and each scan's last one that left no model; null
  /// without Slurm.
  std::shared_ptr<const std::vector<BuildRun>> slurm_runs() const {
    return slurm_ ? slurm_->runs().get() : nullptr;
  }

  /// The builds of worker and Slurm.
  std::vector<BuildRun> build_runs() const;

  /// Makes a build's model the scan's. @throws  as `ScanStore::choose_build`
  void choose_build(std::string_view id, int number) { store_.choose_build(id, number); }

  /// Removes a build. @throws  as `ScanStore::remove_build`, "busy"  also if it belongs to a pose
  void remove_build(std::string_view id, int number);

  /// Has the worker make the model of a stored scan with other options. Only one is made at a time,
  /// because memory is budgeted for one; this waits some seconds for another one. A scan that
  /// starts stops it.
  /// @param options  of the model; `clip` is replaced by the scan's
  /// @return null while a scan or a build runs, or if another model takes too long
  /// @throws Error  if the scan cannot be read, the model is empty or does not fit into memory
  std::unique_ptr<ModelStream> stream_model(std::string_view id, const ReconstructOptions& options);

  /// Has the worker compute the colours of a model, and waits for them. As above, only one such
  /// request is served at a time, and a scan that starts stops it.
  /// @param build  number of the model's build; 0: the scan's own model
  /// @return false while a scan or a build runs, or if another request takes too long
  /// @throws Error  as `octurn::colour_model` and `scan_of_model`; "busy"  if a scan starts
  bool colour_model(const Job& job, int build, Colours shown);

  /// Has the worker call `check` with the rig, between scans, and waits for it. A scan that starts
  /// asks it to stop.
  /// @param check  must return soon after a stop request; its exceptions are rethrown here
  /// @return false if it was not called: a scan runs, a model is made, or the scanner ends
  bool check_devices(std::function<void(Rig& rig, const std::stop_token& stop)> check);

  /// Whether the worker's heartbeat is recent. Takes no lock and does not access the disk, so that
  /// it works while the worker hangs.
  bool is_alive() const;

  /// Asks the worker to end. The destructor does the same, and waits for it.
  void request_stop();

 private:
  bool is_building(std::string_view id) const;
  void expect_idle(std::string_view id) const;
  void expect_not_building(std::string_view id) const;
  void expect_resumable(const Job& job) const;
  void expect_last_pose(const Job& pose) const;
  void expect_solved_lens() const;
  void keep_board_optics(const std::string& serial, const SolvedOptics& optics,
                         const ScanSettings& configured);
  void remove_pose(const Job& pose);
  std::optional<BuildRun> offer_build(BuildCommand command);
  std::optional<Job> hand_over(Job job, Command command);
  bool begin(CalibrationRun run, Command command);
  std::unique_ptr<ModelStream> make_for_request(std::function<void(ModelPipe& pipe)> make);

  ScanStore& store_;
  Limits limits_;
  CalibrationStore calibration_;
  StatusBoard board_;
  Latest<DeviceStates> devices_;
  CommandSlot slot_;
  Heartbeat heartbeat_;
  std::stop_source ending_;
  std::optional<SlurmBuilds> slurm_ = {};
  std::mutex scans_;  // serialises changes of scans' states, and guards the lens
  std::optional<SolvedLens> solved_lens_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
