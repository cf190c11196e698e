#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <tuple>
#include <vector>

#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// Spaces: scans whose snapshots each tell where the sensor was. There is no platform, and no end
/// to the space at the root cube: it is tiled by root cubes, each reconstructed on its own where
/// something is seen, and their surface is one, and closed.
///
/// By the method `solid`, what was seen becomes a closed shell: nobody knows what lies behind it.

/// Whether each shot of a scan tells its own pose.
bool has_free_poses(const Scan& scan);

/// The clip box of a scan with free poses that tells none: around all that it can hold, metres.
inline const Box everywhere{.min = Eigen::Vector3d::Constant(-1e6),
                            .max = Eigen::Vector3d::Constant(1e6)};

/// The thickness of shells by the method `solid`, metres: two voxels.
double shell_thickness(const ReconstructOptions& options);

/// A reconstruction of a space by the method that the options name. It needs no `placements`.
/// @param spool  folder on whose disk finished tiles wait for the surface, as a file without a
///               name; empty: that of temporary files
/// @throws       as `make_reconstructor`
std::unique_ptr<Reconstructor> make_tiled_reconstructor(const ReconstructOptions& options,
                                                        const std::filesystem::path& spool = {});

/// Which of the root cubes that tile space: (0, 0, 0) is the root cube, (1, 0, 0) the same moved by
/// its side along X. Sorted by z, then y, then x.
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
  std::vector<std::size_t> snapshots = {};  ///< that it takes, sorted
  std::size_t bytes = 0;                    ///< of memory for its leaves or voxels, at most
};

/// The tiles of a scan, sorted by their indices; a tile's number is its place in them.
struct TilePlan {
  std::vector<Tile> tiles = {};
  std::vector<std::uint64_t> snapshots = {};  ///< a checksum of each depth image and its pose
};

/// Finds the tiles in which the snapshots see something.
/// @throws  as `make_reconstructor`, and what the source throws
TilePlan plan_tiles(const ReconstructOptions& options, const SnapshotSource& snapshots,
                    const std::stop_token& stop = {});

/// Writes a plan into a file, whole or not at all, for processes that make a tile each.
/// @throws Error "disk-full", "write-failed"
void write_plan(const TilePlan& plan, const ReconstructOptions& options,
                const std::filesystem::path& file);

/// @throws Error "scan-missing"    if there is no such file
/// @throws Error "scan-malformed"  if it is no plan, or was made with other options
TilePlan read_plan(const std::filesystem::path& file, const ReconstructOptions& options);

/// Bytes that the process which makes one tile takes.
std::size_t tile_memory(const ReconstructOptions& options, const Tile& tile);

/// Reconstructs one tile, and writes it into a file that appears whole or not at all.
/// @throws Error "scan-malformed"  if a snapshot is another one than the plan's
/// @throws                     as `make_reconstructor`, and what the source throws
void write_tile(const ReconstructOptions& options, const TilePlan& plan, std::size_t number,
                const SnapshotSource& snapshots, const std::filesystem::path& file,
                const std::stop_token& stop = {});

/// Streams the surface of a space whose tiles were written into files, in any order: the same
/// facets in the same order as `Reconstructor::surface`.
/// @throws Error "scan-missing"    that says the number of a tile that none of the files is
/// @throws Error "scan-malformed"  if one is no tile, is damaged or cut short, or is of another
/// plan
///                                 or other settings than the first; or if two are one tile
SurfaceCount join_tiles(std::span<const std::filesystem::path> files, const FacetSink& sink,
                        const std::stop_token& stop = {});

}  // namespace octurn
