#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/register.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A cache of decoded depth images that are read twice. It stores each image cropped to the
/// bounding box of its readings, until its memory is full.
class KeptFrames {
 public:
  /// @param count      number of images
  /// @param max_bytes  maximum size of the stored images
  KeptFrames(std::size_t count, std::size_t max_bytes);

  /// Stores an image if there is room. Threads may store images of different indices at the same
  /// time.
  void keep(std::size_t index, const DepthFrame& frame);

  /// Returns the whole image; nullopt if it is not stored.
  std::optional<DepthFrame> find(std::size_t index) const;

 private:
  struct Window {
    int width = 0;   // of the image
    int height = 0;  // of the image
    int left = 0;
    int top = 0;
    int columns = 0;
    std::vector<std::uint16_t> depth = {};  // row by row
  };

  std::vector<std::optional<Window>> windows_;
  std::atomic<std::size_t> room_;  // bytes
};

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

/// Solves the sensor's pose for each turn without a solved one, from its snapshots, once. The
/// configured pose stays if the solution is refused or confirms it. A turn that is registered
/// already keeps the pose with which it was. Turns of one rig share the mean of their solved poses.
void solve_rigs(std::vector<StoredTurn>& turns, int threads, const std::stop_token& stop);

/// Returns the pose of a rig that did not move between turns: the mean of the turns' solved poses,
/// weighted by 1 / sigma^2.
/// @return nullopt for fewer than two turns, or if one is more than three sigmas off the mean
std::optional<Eigen::Isometry3d> shared_pose(std::span<const SolvedPose> turns);

/// A file for display in the folder of another pose's scan: samples of the points of this scan and
/// of the earlier ones.
inline constexpr const char* pose_points_file = "pose-points.json";

/// Writes `{"before_mm": [[x, y, z], ...], "pose_mm": [...]}`: points of all turns except the last,
/// in the object's frame, and of the last one, in its platform frame at angle 0. About 100 kB.
///
/// @param points  of each turn, as `Registration` has them
/// @throws Error "disk-full", "write-failed"
void write_pose_points(const std::filesystem::path& folder, const std::vector<StoredTurn>& turns,
                       const std::vector<std::vector<Eigen::Vector3f>>& points);

}  // namespace octurn
