#include "scan/checked_snapshots.hpp"

#include <utility>

namespace octurn {
namespace {

// What is held of each snapshot beside the reconstruction.
constexpr std::size_t check_bytes = 100'000;
constexpr std::size_t calibration_bytes = 350'000;

}  // namespace

ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots) {
  ReconstructOptions options = reconstruct_options(settings, limits);
  const std::size_t each =
      check_bytes + (settings.pose == PoseSource::solved ? calibration_bytes : 0);
  options.program_memory += each * snapshots;
  return options;
}

SnapshotSource checked_snapshots(SnapshotSource snapshots, ScanCheck& check) {
  const std::size_t count = snapshots.count;
  return {.count = count, .read = [&check, read = std::move(snapshots.read)](std::size_t shot) {
            Snapshot snapshot = read(shot);
            if (snapshot.pose == 0) {
              check.add(shot, snapshot);
            }
            return snapshot;
          }};
}

}  // namespace octurn
