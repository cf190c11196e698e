#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "octurn/depth_png.hpp"

namespace octurn {

/// A camera's picture, and the beginning of its exposure by the steady clock.
struct TimedPicture {
  Picture picture = {};
  std::chrono::steady_clock::time_point begin = {};
};

/// A camera that sees lines of lasers, with fixed exposure. Used by one thread at a time.
class Camera {
 public:
  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  virtual const std::string& name() const = 0;

  /// What tells this camera from others of its kind; empty if that is not known.
  virtual std::string serial() const = 0;

  /// Waits for the next picture.
  /// @return nothing if a stop was requested first
  /// @throws Error "sensor-silent" if none comes, "sensor-lost" if the device is gone
  virtual std::optional<TimedPicture> read(const std::stop_token& stop) = 0;

  /// Tells a simulated camera the platform's angle. Others ignore it.
  /// @param angle  radians, counter-clockwise seen from above
  virtual void show_angle(double angle);

  /// Turns the object of a simulated camera over. Others ignore it: a person does it.
  /// @param pose  which way it lies, 0: as it stood at first
  virtual void lay_object(int pose);
};

/// Opens the camera of this machine.
/// @throws Error "sensor-missing"
std::unique_ptr<Camera> open_camera();

}  // namespace octurn
