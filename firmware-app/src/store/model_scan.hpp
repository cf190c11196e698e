#pragma once

#include <filesystem>

#include "octurn/scan_folder.hpp"
#include "store/build_settings.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// Reads a stored scan and applies a build's settings to it. The sensor's pose is not solved yet.
/// @throws Error "bad-settings"  if the settings have a pose, and the scan has several; and as
///                               `read_scan`
Scan scan_to_build(const std::filesystem::path& folder, const BuildSettings& settings);

/// A scan folder, and the scan in it.
struct ModelScan {
  std::filesystem::path folder = {};
  Scan scan = {};
};

/// Returns the scan of a model, with the poses of sensor and object that the model was made with.
/// @param build  number of the model's build; 0: the scan's own model
/// @throws Error "no-model"  if there is no such build; and as `read_scan`
ModelScan scan_of_model(const ScanStore& store, const Job& job, int build);

}  // namespace octurn
