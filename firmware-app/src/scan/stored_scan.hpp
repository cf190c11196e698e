#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "octurn/depth_png.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// The snapshots of a scan folder, where one that is damaged counts as one without a reading: the
/// others still make a model.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop);

/// Stores one more snapshot: first its image, then the scan.json that names it.
/// @throws Error "disk-full", "write-failed"
void store_snapshot(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
                    const DepthFrame& frame);

/// The same of a scan by laser line: its pictures, the dark one first, then one of each laser.
/// @throws Error  as above
void store_pictures(const std::filesystem::path& folder, Scan& scan, double angle,
                    const std::vector<Picture>& pictures);

}  // namespace octurn
