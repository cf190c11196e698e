#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "commands/commands.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "progress_bar.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// The input of `octurn reconstruct`.
struct ReconstructInput {
  ModelSettings settings = {};
  Scan scan = {};                                 ///< with the pose that the model is made with
  std::vector<CalibrationFinding> findings = {};  ///< of solving the pose; of a moved object
  ReconstructOptions options = {};
};

/// Reads the scan, solves its pose if the settings ask for it, and makes options of the settings.
/// @throws Error, Stopped
ReconstructInput read_input(const ReconstructArguments& arguments, const std::stop_token& stop);

/// The scan's snapshots. Reading one updates the progress bar, and throws Stopped once `stop` is
/// requested.
SnapshotSource shown_snapshots(const std::filesystem::path& folder, const Scan& scan,
                               ProgressBar& bar, const std::stop_token& stop);

}  // namespace octurn
