#pragma once

#include <filesystem>

#include "octurn/scan_folder.hpp"
#include "scan/build_settings.hpp"
#include "scan/scan_store.hpp"

namespace octurn {

/// A stored scan as the settings of a build want it, before its pose is solved.
/// @throws Error "bad-settings"  if they have a pose, and the scan is of several; and as
/// `read_scan`
Scan scan_to_build(const std::filesystem::path& folder, const BuildSettings& settings);

/// A scan folder, and the scan in it.
struct ModelScan {
  std::filesystem::path folder = {};
  Scan scan = {};
};

/// The scan that a model was made of, with the poses of the sensor and of the object that it was
/// made with.
/// @param build  that the model is of; 0: what the scan itself made
/// @throws Error "no-model"  if there is no such build; and as `read_scan`
ModelScan scan_of_model(const ScanStore& store, const Job& job, int build);

}  // namespace octurn
