#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config.hpp"
#include "config/config_store.hpp"
#include "doctor/finding.hpp"
#include "doctor/sensor_checks.hpp"
#include "doctor/turntable_checks.hpp"
#include "run/scanner.hpp"

namespace octurn {

/// The scanner that the doctor checks.
struct DoctorInput {
  RigOptions rig = {};
  Config config = {};                                  ///< in force
  std::string settings_trouble = {};                   ///< of the page's settings; empty: none
  std::optional<std::uint64_t> usual_scan_bytes = {};  ///< by earlier scans; nothing: none exist
  LineOwner lines = LineOwner::another;
  std::filesystem::path root = "/";  ///< folder with /dev, /proc, /run and /sys
};

/// The scanner of a daemon, with the configuration and the sensor's pose in force.
DoctorInput doctor_input(const RigOptions& rig, const ConfigStore& settings,
                         const CalibrationStore& calibration, const ScanStore& store);

/// Runs all checks, the sensor's first. Never moves the motor.
std::vector<Finding> run_checks(const DoctorInput& input, const SensorReading& reading);

/// Returns the warnings and faults of the machine checks, which use neither sensor nor turntable.
std::vector<Finding> find_machine_warnings(const DoctorInput& input);

/// Runs all checks in a daemon, on its own scanner. The sensor is read between scans only: during a
/// scan its findings are "unknown".
std::vector<Finding> run_checks(DoctorInput input, Scanner& scanner);

}  // namespace octurn
