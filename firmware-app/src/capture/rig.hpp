#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/lasers.hpp"
#include "capture/platform_swing.hpp"
#include "octurn/lens.hpp"
#include "sensor/depth_sensor.hpp"
#include "settings/laser_settings.hpp"
#include "turntable/simulated_turntable.hpp"
#include "turntable/stepper.hpp"
#include "turntable/stepper_settings.hpp"
#include "turntable/turntable.hpp"

namespace octurn {

/// Opens a camera and the GPIO lines of its lasers, with the lasers off.
/// @throws Error "sensor-missing", "sensor-failed"
CameraAndLasers open_camera_and_lasers(const LaserSettings& settings);

/// How long, and how often, a scan retries a stop at which a device failed: at least once. A Kinect
/// that is plugged in again is ready after 2 to 3 s.
struct Retries {
  std::chrono::duration<double> time = std::chrono::seconds(30);
  std::chrono::duration<double> interval = std::chrono::seconds(2);
};

/// A depth image of the platform at a position.
struct SeenStop {
  DepthFrame image = {};  ///< empty: none was taken
  std::int64_t position = 0;
};

/// The devices to scan with.
struct RigOptions {
  std::string sensor_uri = {};                  ///< device URI of OpenNI2
  double speed = 1.0;                           ///< of a simulated rig, relative to real time
  std::optional<StepperSettings> stepper = {};  ///< of the real turntable; nullopt: it is simulated
  Motion motion = {};                           ///< of a simulated turntable
  /// What a simulated turntable turns; nothing: it has no weight, and follows each pulse at once.
  std::optional<PlatformLoad> load = {};
  double platform_angle_deg = 0;  ///< initial angle
  Retries retries = {};           ///< by the clock of a simulated rig
  /// Time without use after which a `Scanner` switches the sensor off, as its light and its traffic
  /// on USB disturb others; nullopt: never, so that it stays warm.
  std::optional<std::chrono::seconds> sensor_off_after = std::chrono::seconds(30);
  /// Settings of a camera with line lasers, which replaces the depth sensor.
  std::optional<LaserSettings> laser = {};
  /// Of the depth sensor, if they are known, with the depth scale; nothing: those that it reports.
  std::optional<SolvedOptics> optics = {};
  /// Functions that open the devices; tests replace them.
  std::function<std::unique_ptr<DepthSensor>(const std::string& uri)> open_sensor =
      octurn::open_sensor;
  std::function<Stepper::SetLine(const StepperSettings&)> open_lines = open_gpio_lines;
  std::function<CameraAndLasers(const LaserSettings&)> open_camera = open_camera_and_lasers;

  SensorKind kind() const { return laser ? SensorKind::laser_line : SensorKind::depth; }
  bool simulates_sensor() const { return laser ? !stepper : is_simulated_sensor(sensor_uri); }
};

/// The sensor, or a camera with lasers in its place, and the turntable. Used by one thread at a
/// time.
class Rig {
 public:
  explicit Rig(RigOptions options);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Opens the sensor if it is closed. @throws Error "sensor-missing" or "sensor-failed";
  /// "sensor-other" if the rig has a camera with lasers
  DepthSensor& sensor();

  /// Settings of the camera and the lasers; null if the rig has a depth sensor.
  const LaserSettings* laser() const { return options_.laser ? &*options_.laser : nullptr; }

  /// The optics of the depth sensor, for scans and turns.
  const std::optional<SolvedOptics>& optics() const { return options_.optics; }
  void use_optics(const std::optional<SolvedOptics>& optics) { options_.optics = optics; }

  /// Replaces the lens in the camera's settings.
  void use_lens(const CameraLens& lens);

  /// Replaces the camera's pose and the lasers' planes in the settings.
  /// @param lasers  matched by name; a laser that is missing keeps its plane
  void use_pose(const Eigen::Isometry3d& platform_from_sensor, const std::vector<Laser>& lasers);

  /// Opens the camera if it is closed, and with it the GPIO lines of its lasers.
  /// @throws Error  as `open_camera_and_lasers`
  Camera& camera();
  Lasers& lasers();

  /// Sets the pose of a simulated rig's object; see `DepthSensor::set_object_pose`.
  void set_object_pose(int pose);

  /// Closes the sensor, which switches its projector or its lasers off; the next use opens it
  /// again.
  void close_sensor();

  /// The share of the sensor's packets that were lost since the last call, or since the sensor was
  /// opened; 0 if it does not count them.
  double take_lost_share();

  /// When the sensor was opened, and began to warm up; nullopt while it is closed.
  std::optional<std::chrono::steady_clock::time_point> sensor_since() const {
    return sensor_ || camera_ ? std::optional(sensor_since_) : std::nullopt;
  }

  /// For how many whole seconds the sensor has been open; nullopt while it is closed.
  std::optional<double> sensor_on_for() const;

  /// Opens the turntable if it is closed.
  /// @throws Error "turntable-missing" or "turntable-failed"
  Turntable& turntable();

  /// Switches the turntable's motor off. The next move has the configured pace.
  void release_turntable();

  /// Releases the turntable's lines, which switches the motor off. The next use opens them again
  /// with the platform's angle unchanged.
  void close_turntable();

  /// Whether the platform can lag behind the turntable's count. One that has no weight cannot.
  bool can_lose_steps() const { return options_.stepper || options_.load; }

  /// The turntable's pace, as in `Turntable::set_pace`, until it is released.
  double pace() const { return pace_; }
  void set_pace(double pace);

  /// Shows a recording the platform's angle, and a simulated sensor or camera where the platform
  /// is.
  void show_platform();

  /// How long the platform swings after a move.
  Settling& settling() { return settling_; }

  /// What was seen at the last stop of a scan.
  SeenStop& seen_stop() { return seen_stop_; }

  /// The platform's angle, degrees in [0, 360), counter-clockwise seen from above.
  double platform_angle_deg() const;

  /// The number of late pulses of the motor since the construction of this object.
  int late_pulses() const;

 private:
  void show(double angle);

  RigOptions options_;
  int object_pose_ = 0;
  double closed_angle_deg_;     // the platform's angle when the turntable was closed
  int closed_late_pulses_ = 0;  // of the turntables closed so far
  std::unique_ptr<Turntable> turntable_;
  Settling settling_;
  SeenStop seen_stop_;
  double pace_ = 1;                          // of the configured motion
  SimulatedTurntable* simulated_ = nullptr;  // `turntable_`, if it is simulated
  std::unique_ptr<DepthSensor> sensor_;
  std::optional<PacketCounts> counted_ = {};  // the sensor's, when its losses were last taken
  std::unique_ptr<Camera> camera_;
  std::optional<Lasers> lasers_;  // as long as the camera is open
  std::chrono::steady_clock::time_point sensor_since_ = {};
};

}  // namespace octurn
