#pragma once

#include "settings/scan_settings.hpp"

namespace octurn {

/// Settings of a short scan.
inline ScanSettings few_snapshots(int snapshots = 3) {
  return {.snapshots = snapshots, .frames = 2, .leaf_size = 0.004};
}

}  // namespace octurn
