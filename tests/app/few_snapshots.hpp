#pragma once

#include "scan/scan_settings.hpp"

namespace octurn {

/// A scan that is over soon.
inline ScanSettings few_snapshots(int snapshots = 3) {
  return {.snapshots = snapshots, .frames = 2, .leaf_size = 0.004};
}

}  // namespace octurn
