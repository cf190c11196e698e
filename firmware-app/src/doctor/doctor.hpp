#pragma once

#include <filesystem>
#include <vector>

#include "config.hpp"
#include "doctor/finding.hpp"
#include "doctor/sensor_look.hpp"
#include "doctor/turntable_checks.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// A scanner to be checked.
struct Patient {
  RigOptions rig = {};
  Config config = {};  ///< in force
  LineOwner lines = LineOwner::another;
  std::filesystem::path root = "/";  ///< that /dev, /proc, /run and /sys are in
};

/// Every check of a scanner, the sensor's first. Never moves the motor.
/// @param look  what its sensor gave
std::vector<Finding> examine(const Patient& patient, const SensorLook& look);

/// The same for a daemon's own scanner: its sensor is looked at between scans. While one runs, what
/// would disturb it is not measured.
std::vector<Finding> examine(Patient patient, Scanner& scanner);

}  // namespace octurn
