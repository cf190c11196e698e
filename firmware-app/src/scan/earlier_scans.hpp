#pragma once

#include <vector>

#include "scan/scan_estimate.hpp"
#include "scan/scan_store.hpp"

namespace octurn {

/// The finished ones of the last twenty scans of a store, the newest first, with the bytes that
/// their snapshots take on the disk.
std::vector<EarlierScan> earlier_scans(const ScanStore& store);

}  // namespace octurn
