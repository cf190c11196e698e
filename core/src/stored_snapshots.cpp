#include <memory>

#include "laser/laser_lines.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

void fit_to_sensor(ReconstructOptions& options, const Scan& scan) {
  if (scan.laser) {
    options.solid.truncation = laser_truncation;
    options.program_memory += LaserLines::expected_bytes(scan);
  }
}

ReconstructOptions model_options(const Scan& scan) {
  ReconstructOptions options{
      .method = has_free_poses(scan) ? Method::intersection : Method::solid,
      .clip = model_clip(scan),
      .placements = placements(scan),
  };
  if (scan.laser) {
    options.leaf_size = laser_leaf_size;
    options.target_error = laser_target_error;
  }
  fit_to_sensor(options, scan);
  return options;
}

SnapshotSource stored_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                const std::stop_token& stop) {
  if (scan.laser) {
    return {
        .count = scan.shots.size(),
        .read = [stop, lines = std::make_shared<const LaserLines>(folder, scan)](std::size_t i) {
          throw_if_stopped(stop);
          return lines->snapshot(i);
        }};
  }
  return {.count = scan.shots.size(), .read = [=](std::size_t i) {
            throw_if_stopped(stop);
            return read_snapshot(folder, scan, scan.shots[i]);
          }};
}

}  // namespace octurn
