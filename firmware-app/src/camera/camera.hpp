// The interface between the program and its driver of cameras, which is a module: only a program
// that looks with a camera loads it, and libcamera with it.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// A camera's picture, and the beginning of its exposure by the steady clock.
struct TimedPicture {
  Picture picture = {};
  /// Its pixels in colour, of the same luminance; empty: none were asked for, or the camera has
  /// none.
  std::vector<Rgb> colours = {};
  std::chrono::steady_clock::time_point begin = {};
};

/// Capture settings, fixed for the duration of a scan.
struct CameraSettings {
  int width = 0;                               ///< pixels, of the configured lens
  int height = 0;                              ///< pixels
  std::chrono::microseconds exposure{10'000};  ///< of each picture
  double gain = 1;                             ///< of the analogue signal
  double focus = 0.3;                          ///< metres from the lens, where it can be set
};

/// A camera that sees lines of lasers, with fixed exposure. Used by one thread at a time.
class Camera {
 public:
  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  virtual const std::string& name() const = 0;

  /// Serial number, or another stable identifier; empty if it is unknown.
  virtual std::string serial() const = 0;

  /// Waits for the next picture.
  /// @return nothing if a stop was requested first
  /// @throws Error "sensor-silent" if none comes, "sensor-lost" if the device is gone
  virtual std::optional<TimedPicture> read(const std::stop_token& stop) = 0;

  /// As `read`, with colours. The default returns grey pictures only.
  virtual std::optional<TimedPicture> read_in_colour(const std::stop_token& stop);

  /// The time by the clock that tells when its pictures begin: the steady one, unless a test has
  /// its own.
  virtual std::chrono::steady_clock::time_point now() const {
    return std::chrono::steady_clock::now();
  }

  /// Tells a simulated camera the platform's angle. Others ignore it.
  /// @param angle  radians, counter-clockwise seen from above
  virtual void show_angle(double angle);

  /// Turns the object of a simulated camera over. Others ignore it: a person does it.
  /// @param pose  index of the object's placement; 0 is the initial one
  virtual void set_object_pose(int pose);

  /// Waves a printed board before a simulated camera. Others ignore it: a person does it.
  /// @param is_shown  false: it is put away
  virtual void show_board(bool is_shown);
};

/// Opens the first camera of this machine that libcamera knows, and starts it.
/// @throws Error "sensor-missing"  if there is none, or no driver for cameras
/// @throws Error "sensor-other"    if it makes no pictures of the size, or of no layout that is
/// read
/// @throws Error "sensor-failed"   if it is in use, or does not start
std::unique_ptr<Camera> open_camera(const CameraSettings& settings);

/// What the module libOcturnCamera offers, as its symbol `octurn_camera`.
struct CameraModule {
  /// @throws Error  as `open_camera`
  std::unique_ptr<Camera> (*open)(const CameraSettings& settings) = nullptr;
};

}  // namespace octurn
