#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"
#include "scan/build_run.hpp"
#include "scan/calibration_turn.hpp"
#include "scan/job.hpp"
#include "scan/latest.hpp"
#include "scan/lens_files.hpp"
#include "scan/rig.hpp"
#include "scan/scan_label.hpp"
#include "scan/sensor_map_files.hpp"
#include "scan/time_left.hpp"

namespace octurn {

/// How a sensor or a turntable is, as far as the last use of it told.
struct DeviceStatus {
  enum class State { unknown, ready, missing, failed };
  State state = State::unknown;
  std::string name = {};
  bool simulated = false;
  Failure failure = {};  ///< what is wrong, or empty
};

/// A device as the API has it.
nlohmann::json to_json(const DeviceStatus& device);

/// A scan on its way, or the one that was started or resumed last.
struct Status {
  using Clock = std::chrono::steady_clock;

  DeviceStatus sensor = {};
  DeviceStatus turntable = {};
  std::optional<Job> job = {};
  Clock::time_point job_started = {};
  std::optional<ExpectedEnd> job_end = {};
  std::optional<Clock::time_point> job_gives_up = {};  ///< at a stop where a device fails

  bool is_measuring = false;  ///< the rig, with a turn or a wall
  bool is_building = false;   ///< a model from a stored scan, to be kept

  bool is_scanning() const { return job && job->state == JobState::running; }
  bool busy() const { return is_scanning() || is_measuring || is_building; }
};

/// The last depth image of the sensor, or the last picture of a camera with lasers, or why there is
/// none.
struct CameraFrame {
  std::chrono::steady_clock::time_point time = {};
  DepthFrame frame = {};
  Intrinsics lens = {};  ///< of the sensor
  Picture picture = {};  ///< in place of both
  std::optional<Failure> failure = {};

  bool has_image() const { return frame.width > 0 || picture.width > 0; }
};

/// The sensor that is open, or was last.
struct KnownSensor {
  std::string serial = {};  ///< empty before one was opened, or where it tells none
  std::optional<std::chrono::steady_clock::time_point> since =
      {};                                    ///< when it opened; none: closed
  std::optional<SensorMapSummary> map = {};  ///< none: this machine has none of it
  std::optional<KeptLens> lens = {};         ///< the same, of a camera
};

/// A coarse mesh of the snapshots so far of the scan that was started last.
struct MeshPreview {
  std::string id = {};  ///< of the scan
  int snapshots = 0;    ///< that it shows; 0 if there is nothing to show yet
  std::string stl = {};
};

/// Tells everybody how the devices are, what the scan does and what the sensor sees. Only written
/// by those who know it; nothing is decided from what stands here. Any thread may call anything.
class StatusBoard {
 public:
  explicit StatusBoard(const RigOptions& rig);

  /// With the times of a running scan as they are now. Touches no disk.
  Status status() const;
  const Latest<Status>& latest_status() const { return status_; }
  const Latest<CameraFrame>& camera_frame() const { return camera_frame_; }
  /// The measurement that goes on, or the last one; nothing if there was none.
  const Latest<std::optional<CalibrationRun>>& calibration_run() const { return calibration_run_; }
  /// The build that waits or goes on, or the last one; nothing if there was none.
  const Latest<std::optional<BuildRun>>& build_run() const { return build_run_; }
  const Latest<MeshPreview>& mesh_preview() const { return mesh_preview_; }
  const Latest<KnownSensor>& known_sensor() const { return known_sensor_; }

  /// A scan begins or goes on.
  void begin_scan(const Job& job, Status::Clock::time_point started);

  /// What has become of the scan that was begun last. Its name stays.
  /// @param gives_up  when it tries a stop no more where a device fails; none: no device fails
  void set_job(const Job& job, const std::optional<ExpectedEnd>& expected_end = {},
               const std::optional<Status::Clock::time_point>& gives_up = {});

  /// What a person called a scan.
  void label(std::string_view id, const LabelChange& change);

  void set_sensor_ready(const std::string& name);
  void set_turntable_ready();

  /// Why the sensor, or the turntable, cannot be used.
  void set_sensor_failed(const Failure& failure);
  void set_turntable_failed(const Failure& failure);

  void set_camera_frame(const DepthFrame& frame, const Intrinsics& lens);
  void set_camera_picture(const Picture& picture);
  void set_calibration_run(CalibrationRun run);
  void set_known_sensor(KnownSensor sensor) { known_sensor_.set(std::move(sensor)); }
  void set_sensor_closed();
  void clear_sensor_map();
  /// What is kept of the camera's lens now.
  void set_lens(std::optional<KeptLens> lens);
  /// There is no measurement any more to tell of.
  void forget_calibration_run();
  void set_build_run(BuildRun run);
  /// The build that waits will never begin, for this reason.
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

}  // namespace octurn
