#pragma once

#include <vector>

#include "scan/scan_estimate.hpp"
#include "scan/scan_store.hpp"

namespace octurn {

/// The finished scans of a store, the newest first, with what their snapshots take on the disk.
/// Looks at the last twenty, and their folders, only.
std::vector<EarlierScan> earlier_scans(const ScanStore& store);

}  // namespace octurn
