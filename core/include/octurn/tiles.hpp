#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <tuple>
#include <vector>

#include "octurn/model.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// Spaces larger than a root cube, from scans in which each snapshot has the sensor's pose. There
/// is no platform. Space is tiled by root cubes; each tile in which something is seen is
/// reconstructed on its own, and the surfaces join to one closed surface.
///
/// The method `solid` makes a closed shell of every surface, as inside cannot be known from
/// outside.

/// A reconstruction of a space by the options' method. `placements` must be empty.
/// @param spool  a folder; finished tiles are kept in an unnamed file on its disk until the surface
///               is drawn. Empty: the folder of temporary files
/// @throws       as `make_reconstructor`
std::unique_ptr<Reconstructor> make_tiled_reconstructor(const ReconstructOptions& options,
                                                        const std::filesystem::path& spool = {});

/// How far the depth images of a space agree about it. With wrong poses, or a wrong depth unit,
/// few of them do.
struct ViewAgreement {
  std::size_t compared = 0;      ///< readings of one image that fall on readings of another
  std::size_t agreeing = 0;      ///< of these, within 5 % of the other's depth
  std::size_t contradicted = 0;  ///< of these, in space that the other saw to be free
  double gap = 0;  ///< metres: median distance along the other's ray, of the agreeing ones

  /// The share of agreeing readings among those that the other image does not hide; 1 if there are
  /// none.
  double share() const;

  /// Agreeing less contradicted readings: by wrong poses many may agree, but more contradict.
  double net() const { return static_cast<double>(agreeing) - static_cast<double>(contradicted); }

  /// Whether some agree, and at most two in five contradict. Noise, and what moved in the scene,
  /// contradict right poses, too.
  bool is_credible() const { return agreeing > 0 && share() >= 0.6; }
};

/// Compares each depth image with each other one, on a grid of 40 pixels a row. Takes about 0.1 ms
/// for a pair.
ViewAgreement compare_views(std::span<const Snapshot> views);

/// Reads at most 24 snapshots, evenly spread over a scan.
std::vector<Snapshot> spread_views(const SnapshotSource& snapshots);

/// The index of a tile: (0, 0, 0) is the root cube, (1, 0, 0) the cube beside it along X. Sorted by
/// z, then y, then x.
struct TileIndex {
  int x = 0;
  int y = 0;
  int z = 0;
  friend bool operator==(const TileIndex&, const TileIndex&) = default;
  friend bool operator<(const TileIndex& a, const TileIndex& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  }
};

/// A tile in which something is seen.
struct Tile {
  TileIndex index = {};
  std::vector<std::size_t> snapshots = {};  ///< sorted indices of snapshots that observe it
  std::size_t bytes = 0;                    ///< upper bound of its leaves' or voxels' memory
};

/// The tiles of a scan. A tile's number is its position in `tiles`.
struct TilePlan {
  std::vector<Tile> tiles = {};               ///< sorted by their indices
  std::vector<std::uint64_t> snapshots = {};  ///< checksum of each image, its intrinsics and pose
};

/// Finds the tiles in which the snapshots see something.
/// @throws  as `make_reconstructor`, and whatever the source throws
TilePlan plan_tiles(const ReconstructOptions& options, const SnapshotSource& snapshots,
                    const std::stop_token& stop = {});

/// Writes a plan into a file, whole or not at all, for processes that each make one tile.
/// @throws Error "disk-full", "write-failed"
void write_plan(const TilePlan& plan, const ReconstructOptions& options,
                const std::filesystem::path& file);

/// @throws Error "scan-missing"    if there is no such file
/// @throws Error "scan-malformed"  if it is not a plan, or was made with other options
TilePlan read_plan(const std::filesystem::path& file, const ReconstructOptions& options);

/// Memory of a process that makes one tile, bytes.
std::size_t tile_memory(const ReconstructOptions& options, const Tile& tile);

/// Reconstructs one tile, and writes it into a file that appears whole or not at all.
/// @param number  of the tile in the plan
/// @throws Error "scan-malformed"  if a snapshot differs from the plan's
/// @throws  as `make_reconstructor`, and whatever the source throws
void write_tile(const ReconstructOptions& options, const TilePlan& plan, std::size_t number,
                const SnapshotSource& snapshots, const std::filesystem::path& file,
                const std::stop_token& stop = {});

/// Streams the surface of a space whose tiles were written into files: the same facets in the same
/// order as `Reconstructor::surface` has them.
/// @param files  in any order
/// @throws Error "scan-missing"    with the number of a missing tile
/// @throws Error "scan-malformed"  if a file is not a tile, is damaged, or belongs to another plan
///                                 or other settings than the first; or if two have the same number
SurfaceCount join_tiles(std::span<const std::filesystem::path> files, const FacetSink& sink,
                        const std::stop_token& stop = {});

/// Writes that surface as binary STL, which appears whole or not at all.
/// @throws  as above; Error "empty" if there is no surface, "disk-full", "write-failed"
ModelReport join_tiles(std::span<const std::filesystem::path> files,
                       const std::filesystem::path& model, const std::stop_token& stop = {});

}  // namespace octurn
