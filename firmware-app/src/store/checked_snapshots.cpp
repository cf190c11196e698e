#include "store/checked_snapshots.hpp"

#include <algorithm>
#include <utility>

namespace octurn {
namespace {

// Memory for each snapshot in addition to the reconstruction.
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

PoseChecks::PoseChecks(std::vector<Placement> placements, const Box& clip, std::size_t stops)
    : placements_(std::move(placements)) {
  if (placements_.empty()) {
    placements_.push_back({.clip = clip});
  }
  for (const Placement& placement : placements_) {
    checks_.push_back(std::make_unique<ScanCheck>(placement.clip, stops));
  }
}

void PoseChecks::add(std::size_t stop, const Snapshot& snapshot) {
  const auto pose = static_cast<std::size_t>(snapshot.pose);
  if (placements_[pose].object_from_platform.matrix().isIdentity(0)) {
    checks_[pose]->add(stop, snapshot);
    return;
  }
  Snapshot seen = snapshot;
  seen.object_from_sensor =
      placements_[pose].object_from_platform.inverse() * snapshot.object_from_sensor;
  checks_[pose]->add(stop, seen);
}

std::vector<ScanFigures> PoseChecks::figures(int threads) const {
  std::vector<ScanFigures> all;
  for (std::size_t pose = 0; pose < checks_.size(); ++pose) {
    ScanFigures figures = checks_[pose]->figures(threads);
    const auto move = [&](std::vector<Eigen::Vector3d>& places) {
      for (Eigen::Vector3d& place : places) {
        place = placements_[pose].object_from_platform * place;
      }
    };
    std::ranges::for_each(figures.cut_places, move);
    move(figures.disagreeing_places);
    move(figures.contradicted_places);
    move(figures.seen);
    all.push_back(std::move(figures));
  }
  return all;
}

SnapshotSource checked_snapshots(SnapshotSource snapshots, PoseChecks& checks) {
  const std::size_t count = snapshots.count;
  return {.count = count, .read = [&checks, read = std::move(snapshots.read)](std::size_t shot) {
            Snapshot snapshot = read(shot);
            checks.add(shot, snapshot);
            return snapshot;
          }};
}

}  // namespace octurn
