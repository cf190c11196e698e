#pragma once

#include <memory>

#include "appliance/appliance.hpp"
#include "config/config_store.hpp"
#include "doctor/doctor.hpp"
#include "doctor/machine_warnings.hpp"
#include "doctor/turntable_runner.hpp"
#include "http/access_keys.hpp"
#include "http/page.hpp"
#include "scan/earlier_scans.hpp"
#include "scan/scanner.hpp"

namespace octurn {

/// What requests are answered from: the scanner, what it has stored, and the page that shows it.
struct App {
  Scanner& scanner;
  const ScanStore& store;
  const Page& page;
  ConfigStore& settings;
  TurntableRunner& turntable;
  AccessKeys& keys;
  RigOptions rig;                  ///< that the scanner works with
  Appliance* appliance = nullptr;  ///< that this machine is; null: none
  std::unique_ptr<MachineWarnings> warnings = std::make_unique<MachineWarnings>();

  /// This scanner, with the configuration and the sensor's pose in force.
  DoctorInput doctor_input() const {
    Config config = settings.config();
    config.scan = scanner.calibration().in_force(config.scan);
    const ScanEstimate estimate = estimate_scan(earlier_scans(store), config.scan);
    return {.rig = rig,
            .config = config,
            .settings_trouble = settings.trouble(),
            .usual_scan_bytes = estimate.is_measured && estimate.bytes > 0
                                    ? std::optional(estimate.bytes)
                                    : std::nullopt};
  }
};

}  // namespace octurn
