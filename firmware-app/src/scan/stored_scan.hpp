#pragma once

#include <filesystem>
#include <stop_token>

#include "octurn/scan_folder.hpp"

namespace octurn {

/// The snapshots of a scan folder, where one that is damaged counts as one without a reading: the
/// others still make a model.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop);

}  // namespace octurn
