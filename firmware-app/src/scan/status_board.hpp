#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "octurn/depth_frame.hpp"
#include "octurn/reconstruct.hpp"
#include "scan/job.hpp"
#include "scan/latest.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// How a sensor or a turntable is, as far as the last use of it told.
struct DeviceStatus {
  enum class State { ready, missing, failed };
  State state = State::missing;
  std::string name = {};
  bool simulated = false;
  Failure failure = {};  ///< what is wrong, or empty
};

/// A device as the API has it.
nlohmann::json json_of(const DeviceStatus& device);

struct Status {
  DeviceStatus sensor = {};
  DeviceStatus turntable = {};
  std::optional<Job> job = {};  ///< the scan that was started or resumed last, running or not
  std::chrono::steady_clock::time_point job_started = {};
  std::optional<std::chrono::steady_clock::time_point> job_end = {};  ///< as expected

  bool busy() const { return job && job->state == JobState::running; }
};

/// What the sensor saw last, or why it saw nothing.
struct View {
  std::chrono::steady_clock::time_point time = {};
  DepthFrame frame = {};
  double depth_unit = 0;  ///< metres
  std::optional<Failure> failure = {};
};

/// A coarse mesh of what the scan that was started last has seen so far.
struct Preview {
  std::string id = {};  ///< of the scan
  int snapshots = 0;    ///< that it shows; 0 if there is nothing to show yet
  std::string stl = {};
};

/// What the worker tells everybody else: how the devices are, what the scan does, what was seen.
/// Any thread may call anything.
class StatusBoard {
 public:
  explicit StatusBoard(const RigOptions& rig);

  /// With the times of a running scan as they are now.
  Status status() const;
  const Latest<Status>& latest_status() const { return status_; }
  const Latest<View>& view() const { return view_; }
  const Latest<Preview>& preview() const { return preview_; }

  /// A scan begins or goes on.
  void set_job(const Job& job);
  void set_progress(Phase phase, int snapshots_done);

  /// What a running scan is trying again, until its next snapshot.
  void set_trouble(const Failure& failure);

  /// What has become of a scan, if it is the one that was started last.
  void set_outcome(const Job& job);

  void set_sensor_ready(const std::string& name);
  void set_turntable_ready();

  /// Why the sensor, or the turntable, cannot be used.
  void set_sensor_failed(const Failure& failure);
  void set_turntable_failed(const Failure& failure);

  void set_view(const DepthFrame& frame, double depth_unit);
  void set_preview(const std::string& id, const Reconstructor& seen, int snapshots,
                   const std::stop_token& stop);

 private:
  Latest<Status> status_;
  Latest<View> view_;
  Latest<Preview> preview_;
};

}  // namespace octurn
