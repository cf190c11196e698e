#pragma once

#include <filesystem>

namespace octurn {

/// Whether a line of the GPIO header becomes an input when a program ends without setting it, so
/// that a resistor at it decides. The kernel of Raspberry Pi OS keeps its last level instead,
/// unless it is asked not to: a laser would stay on.
/// @param sys  where sysfs is mounted
/// @throws Error "sensor-failed"  that says what to set
void expect_released_lines_to_fall(const std::filesystem::path& sys = "/sys");

}  // namespace octurn
