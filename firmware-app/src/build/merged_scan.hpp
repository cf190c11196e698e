#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "octurn/register.hpp"
#include "octurn/scan_folder.hpp"
#include "store/kept_frames.hpp"

namespace octurn {

/// One turn of the platform in a stored scan.
struct StoredTurn {
  std::filesystem::path folder = {};
  Scan scan = {};  ///< of this turn alone: its shots, rig and clip box, and no poses
  /// The object's pose, if the folder's scan has it.
  std::optional<Eigen::Isometry3d> object_from_platform = {};
  /// A person's estimate of that pose, which registration refines.
  std::optional<Eigen::Isometry3d> prior_object_from_platform = {};
  bool is_rig_solved = false;  ///< registration has solved the sensor's pose, or refused to
  /// Depth images, cached from solving to registering.
  std::shared_ptr<const KeptFrames> kept = {};
  /// Bounding box of each stop's points inside the clip box, set by registration: metres, platform
  /// frame at angle 0.
  std::vector<Eigen::AlignedBox3d> extents = {};
};

/// Reads the turns of scan folders, in their order. Object poses are read from the first folder
/// only: each folder has its own object frame.
/// @throws Error "scan-malformed"  if a scan has no turns, or another sensor than the first; others
///                                 as `read_scan`
std::vector<StoredTurn> read_turns(const std::vector<std::filesystem::path>& folders);

/// Registers the turns, and sets their `extents`. Solves the sensor's pose first, for each turn
/// that has no solved one and is not registered yet, from its snapshots. The configured pose stays
/// if the solution is refused or confirms it. Turns of one rig share the mean of their solved
/// poses.
/// @throws Error, Stopped  as `read_snapshot` and `register_turns`
Registration register_turns(std::vector<StoredTurn>& turns, int threads,
                            const std::stop_token& stop);

/// Writes one scan folder of several poses, atomically. Its snapshots are hard links to those of
/// the turns, or copies where the file system has no hard links. The clip box of each pose is
/// shrunk to the points inside it.
///
/// @param folder  must not exist, or be empty
/// @throws Error "disk-full", "write-failed"
void write_merged_scan(const std::filesystem::path& folder, const std::vector<StoredTurn>& turns,
                       const Registration& registration);

}  // namespace octurn
