#pragma once

#include <numbers>

namespace octurn {

/// Conversions between SI and the units that people, files and slicers use. Nowhere else is a
/// number multiplied by 1000 or divided by 180.

constexpr double metres_from_mm(double mm) { return mm / 1000.0; }
constexpr double mm_from_metres(double metres) { return metres * 1000.0; }
constexpr double radians_from_degrees(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double degrees_from_radians(double radians) { return radians * 180.0 / std::numbers::pi; }
constexpr double m3_from_mm3(double mm3) { return mm3 / 1e9; }
constexpr double cm3_from_m3(double m3) { return m3 * 1e6; }
constexpr double m3_from_cm3(double cm3) { return cm3 / 1e6; }
constexpr double mb_from_bytes(double bytes) { return bytes / (1024.0 * 1024.0); }
constexpr double bytes_from_kb(double kb) { return kb * 1024.0; }
constexpr double bytes_from_mb(double mb) { return mb * 1024.0 * 1024.0; }
constexpr double decimal_mb_from_bytes(double bytes) { return bytes / 1e6; }
constexpr double decimal_gb_from_bytes(double bytes) { return bytes / 1e9; }
constexpr double celsius_from_millicelsius(double millicelsius) { return millicelsius / 1000.0; }

}  // namespace octurn
