#pragma once

#include <atomic>
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/lens_files.hpp"
#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "capture/calibration_turn.hpp"
#include "capture/rig.hpp"
#include "failure.hpp"
#include "latest.hpp"
#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"
#include "store/builds.hpp"
#include "store/job.hpp"
#include "store/scan_estimate.hpp"

namespace octurn {

/// When something is expected to end.
struct ExpectedEnd {
  using Clock = std::chrono::steady_clock;

  Clock::time_point end = {};
  Seconds later = {};  ///< time of the steps after the current one

  /// Returns the remaining time at `now`: at least `later`, even if the current step takes longer
  /// than expected.
  Seconds left(Clock::time_point now) const;
};

/// Estimates the remaining time of a scan: the remaining stops times the median time of the last
/// five, plus the model's time from earlier scans. Updates, at stops and while the model is made,
/// raise the estimate by at most a tenth, because people do not believe a number that jumps.
class TimeLeft {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param before     estimate from earlier scans
  /// @param stops      number of stops of the whole turn
  /// @param snapshots  number already taken, of a resumed scan
  TimeLeft(const ScanEstimate& before, int stops, int snapshots, Clock::time_point now);

  /// Reports the number of stored snapshots.
  void count(int snapshots, Clock::time_point now);

  /// Reports that the last snapshot is stored, and the model is begun.
  void begin_model(Clock::time_point now);

  /// Reports the fraction of the snapshots, 0 to 1, that were added again since `since`.
  void count_model(double share, Clock::time_point since, Clock::time_point now);

  /// Drops the estimate: a device failed, for an unknown time.
  void lose_pace();

  /// The estimate; nullopt if it is unknown.
  const std::optional<ExpectedEnd>& expected() const { return expected_; }

 private:
  void tell_turn(Clock::time_point now);
  void tell(Seconds left, Seconds later, Clock::time_point now);

  ScanEstimate before_;
  int stops_;
  int snapshots_;
  std::optional<Clock::time_point> last_ = {};  // of the last snapshot; nullopt: after a failure
  std::vector<double> pace_ = {};               // seconds, of the last stops
  std::optional<ExpectedEnd> expected_ = {};
};

/// State of a sensor or a turntable, as of its last use.
struct DeviceStatus {
  enum class State { unknown, ready, missing, failed };
  State state = State::unknown;
  std::string name = {};
  bool simulated = false;
  Failure failure = {};  ///< what is wrong, or empty
};

/// JSON of a device, for the API.
nlohmann::json to_json(const DeviceStatus& device);

/// State of the devices, and of the scan that runs, or was started or resumed last.
struct Status {
  using Clock = std::chrono::steady_clock;

  DeviceStatus sensor = {};
  DeviceStatus turntable = {};
  std::optional<Job> job = {};
  Clock::time_point job_started = {};
  std::optional<ExpectedEnd> job_end = {};
  std::optional<Clock::time_point> job_gives_up = {};  ///< when retries of a failing stop end

  bool is_measuring = false;  ///< the rig, by a turn, a wall or a board
  bool is_building = false;   ///< a build of a stored scan waits or runs

  bool is_scanning() const { return job && job->state == JobState::running; }
  bool busy() const { return is_scanning() || is_measuring || is_building; }
};

/// The last depth image of the sensor, or the last picture of a camera with lasers, or the failure
/// of the device.
struct CameraFrame {
  std::chrono::steady_clock::time_point time = {};
  DepthFrame frame = {};
  Intrinsics lens = {};  ///< of the sensor
  Picture picture = {};  ///< of a camera with lasers, replaces both
  std::optional<Failure> failure = {};

  bool has_image() const { return frame.width > 0 || picture.width > 0; }
};

/// The sensor that is open, or was open last.
struct KnownSensor {
  std::string serial = {};  ///< empty before the first one is opened, or if it has none
  std::optional<std::chrono::steady_clock::time_point> since =
      {};                                    ///< when it opened; nullopt: closed
  std::optional<SensorMapSummary> map = {};  ///< nullopt: this machine has none of it
  std::optional<KeptLens> lens = {};         ///< stored lens of a camera; nullopt: none
  bool has_infrared = false;                 ///< a depth sensor that can look at a board
  /// Of a depth sensor: those in force, then the earlier ones; empty: as the sensor reports.
  std::vector<OpticsRecord> optics = {};
};

/// A coarse mesh of the snapshots so far of the scan that was started last.
struct MeshPreview {
  std::string id = {};  ///< of the scan
  int snapshots = 0;    ///< in the mesh; 0: nothing to show yet
  std::string stl = {};
};

/// The published state of devices, scan, builds and measurements, and what the sensor sees. The
/// worker and the Scanner write it, and decide nothing by it. Thread-safe.
class StatusBoard {
 public:
  explicit StatusBoard(const RigOptions& rig);

  /// Returns the status with the current times of a running scan. Does not access the disk.
  Status status() const;
  const Latest<Status>& latest_status() const { return status_; }
  const Latest<CameraFrame>& camera_frame() const { return camera_frame_; }
  /// The running measurement, or the last one; nullopt if there was none.
  const Latest<std::optional<CalibrationRun>>& calibration_run() const { return calibration_run_; }
  /// The build that waits or runs, or the last one; nullopt if there was none.
  const Latest<std::optional<BuildRun>>& build_run() const { return build_run_; }
  const Latest<MeshPreview>& mesh_preview() const { return mesh_preview_; }
  const Latest<KnownSensor>& known_sensor() const { return known_sensor_; }

  /// Publishes a scan that starts or resumes.
  void begin_scan(const Job& job, Status::Clock::time_point started);

  /// Publishes the state of that scan; has no effect for another one. Its label is kept.
  /// @param gives_up  when retries of a failing stop end; nullopt: no device fails
  void set_job(const Job& job, const std::optional<ExpectedEnd>& expected_end = {},
               const std::optional<Status::Clock::time_point>& gives_up = {});

  /// Publishes a person's change of a scan's label.
  void label(std::string_view id, const LabelChange& change);

  void set_sensor_ready(const std::string& name);
  void set_turntable_ready();

  /// Publishes why the sensor, or the turntable, cannot be used.
  void set_sensor_failed(const Failure& failure);
  void set_turntable_failed(const Failure& failure);

  void set_camera_frame(DepthFrame frame, const Intrinsics& lens);
  void set_camera_picture(Picture picture);
  /// Publishes the optics of the depth sensor, and the map that was made with them.
  void set_optics(std::vector<OpticsRecord> optics, std::optional<SensorMapSummary> map);
  void set_calibration_run(CalibrationRun run);
  void set_known_sensor(KnownSensor sensor) { known_sensor_.set(std::move(sensor)); }
  void set_sensor_closed();
  void clear_sensor_map();
  /// Publishes the stored lens of the camera; nullopt: none.
  void set_lens(std::optional<KeptLens> lens);
  /// Clears the last measurement.
  void forget_calibration_run();
  void set_build_run(BuildRun run);
  /// Publishes that the waiting build is cancelled, for this reason.
  void drop_waiting_build(const std::optional<Failure>& reason);
  void set_mesh_preview(MeshPreview preview) { mesh_preview_.set(std::move(preview)); }

 private:
  Latest<Status> status_;
  Latest<CameraFrame> camera_frame_;
  Latest<std::optional<CalibrationRun>> calibration_run_;
  Latest<std::optional<BuildRun>> build_run_;
  Latest<MeshPreview> mesh_preview_;
  Latest<KnownSensor> known_sensor_;
};

/// The devices as of the worker's last use of them. The worker sets them for the decisions of other
/// threads; the StatusBoard shows more of them, for display.
struct DeviceStates {
  bool sensor_is_ready = false;
  std::string serial = {};  ///< of the sensor opened last; empty: none yet, or it has none
  bool turntable_is_ready = false;
  std::optional<Failure> turntable_failure = {};
};

/// Shows that a thread is still working. Any thread may read it.
class Heartbeat {
 public:
  using Clock = std::chrono::steady_clock;

  /// Called by the thread between two of its waits.
  void beat() { last_ = Clock::now().time_since_epoch().count(); }

  /// Called before work of unbounded duration, such as a reconstruction: alive until the next beat.
  void suspend() { last_ = Clock::duration::max().count(); }

  /// Whether the last beat is not older than `max_silence`.
  bool is_alive(Clock::duration max_silence) const {
    const Clock::duration last(last_.load());
    return last == Clock::duration::max() || Clock::now().time_since_epoch() - last <= max_silence;
  }

 private:
  std::atomic<Clock::rep> last_ = Clock::now().time_since_epoch().count();
};

}  // namespace octurn
