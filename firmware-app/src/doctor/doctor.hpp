#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config.hpp"
#include "doctor/finding.hpp"
#include "doctor/sensor_reading.hpp"
#include "doctor/turntable_checks.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// The scanner that the doctor checks.
struct DoctorInput {
  RigOptions rig = {};
  Config config = {};                 ///< in force
  std::string settings_trouble = {};  ///< of the page's settings; empty: none
  LineOwner lines = LineOwner::another;
  std::filesystem::path root = "/";  ///< folder with /dev, /proc, /run and /sys
};

/// Runs all checks, the sensor's first. Never moves the motor.
std::vector<Finding> run_checks(const DoctorInput& input, const SensorReading& reading);

/// Runs all checks in a daemon, on its own scanner. The sensor is read between scans only: during a
/// scan its findings are "unknown".
std::vector<Finding> run_checks(DoctorInput input, Scanner& scanner);

}  // namespace octurn
