#pragma once

#include <vector>

#include "store/scan_estimate.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// Returns the last twenty finished scans of a store, newest first, with the sizes of their
/// snapshots on the disk.
std::vector<EarlierScan> earlier_scans(const ScanStore& store);

}  // namespace octurn
