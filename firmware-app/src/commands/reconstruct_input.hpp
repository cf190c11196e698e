#pragma once

#include <filesystem>
#include <stop_token>

#include "commands/commands.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "progress_bar.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// The input of `octurn reconstruct`.
struct ReconstructInput {
  ModelSettings settings = {};
  ModelInput model = {};
};

/// Reads the scan, and makes options of the settings. @throws Error
ReconstructInput read_input(const ReconstructArguments& arguments);

/// The scan's snapshots. Reading one updates the progress bar, and throws Stopped once `stop` is
/// requested.
SnapshotSource shown_snapshots(const std::filesystem::path& folder, const Scan& scan,
                               ProgressBar& bar, const std::stop_token& stop);

}  // namespace octurn
