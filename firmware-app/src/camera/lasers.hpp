#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/camera.hpp"

namespace octurn {

/// The line lasers of a rig. At most one is on, for the lifetime of a `Light`; all others are off,
/// also after an exception. When the program ends, however it ends, the kernel releases their
/// lines, and the resistors at them keep the lasers off.
class Lasers {
 public:
  /// Sets the line of a laser. Its copies hold the lines: the end of the last one releases them.
  using SetLine = std::function<void(std::size_t laser, bool on)>;

  /// One laser that is on, until this ends.
  class Light {
   public:
    Light(Lasers& lasers, std::size_t laser);
    ~Light();
    Light(const Light&) = delete;
    Light& operator=(const Light&) = delete;

   private:
    Lasers& lasers_;
    std::size_t laser_;
  };

  /// Switches all off.
  /// @param set_line  called by one thread at a time
  Lasers(std::size_t count, SetLine set_line);
  ~Lasers();
  Lasers(const Lasers&) = delete;
  Lasers& operator=(const Lasers&) = delete;

  std::size_t count() const { return count_; }

  /// How many pictures the camera is late: so many more show a laser as it was before it was
  /// switched. Nothing: not measured yet.
  std::optional<int> late_pictures = {};

  /// Switches a laser on. No other may be on.
  /// @throws Error "sensor-failed"  if a line could not be set before: then all were released
  [[nodiscard]] Light light(std::size_t laser) { return {*this, laser}; }

 private:
  void switch_off(std::size_t laser);

  std::size_t count_;
  SetLine set_line_;  // empty: the lines were released
};

/// A camera and the lasers whose lines it sees.
struct CameraAndLasers {
  std::unique_ptr<Camera> camera = {};
  Lasers::SetLine set_line = {};
};

/// Drives lines of the GPIO header as long as the returned function or a copy of it lives, all low
/// at first, which is off.
/// @param lines  the kernel's names, "GPIO23"
/// @throws Error "sensor-missing"  if this machine has no such header
/// @throws Error "sensor-failed"   if a line does not exist, is in use, or may not be used
Lasers::SetLine open_laser_lines(const std::vector<std::string>& lines);

/// Whether a line of the GPIO header becomes an input when a program ends without setting it, so
/// that a resistor at it decides. The kernel of Raspberry Pi OS keeps its last level instead,
/// unless it is asked not to: a laser would stay on.
/// @param sys  where sysfs is mounted
/// @throws Error "sensor-failed"  that says what to set
void expect_released_lines_to_fall(const std::filesystem::path& sys = "/sys");

}  // namespace octurn
