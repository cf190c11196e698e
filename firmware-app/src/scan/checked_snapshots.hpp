#pragma once

#include <cstddef>

#include "octurn/quality.hpp"
#include "octurn/snapshot.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

/// The options of a model whose snapshots are checked, and whose pose may be solved: what is held
/// of each snapshot for that is left to them.
ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots);

/// The same snapshots; `check` looks at each of the first pose, whose platform it knows, that is
/// read, and has to outlive them.
SnapshotSource checked_snapshots(SnapshotSource snapshots, ScanCheck& check);

}  // namespace octurn
