#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "io/unnamed_file.hpp"
#include "octurn/tiles.hpp"
#include "tiles/tile_files.hpp"
#include "tiles/tile_lattice.hpp"

namespace octurn {

/// Reconstructs a space tile by tile. Adding snapshots plans the tiles (`plan_tiles`). `surface`
/// makes the tiles, as many at once as fit in the memory limit (`make_tiles`), stores them in an
/// unnamed file, and draws their surface (`tile_surface`).
class TiledReconstructor final : public Reconstructor {
 public:
  TiledReconstructor(const ReconstructOptions& options, std::filesystem::path spool);
  void add(const Snapshot& snapshot, const std::stop_token& stop = {}) override;
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                       const std::stop_token& stop = {}) override;
  SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;

  /// Streams nothing: there is no surface before all snapshots are known.
  void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
               const std::stop_token& stop = {}) const override;

 private:
  void make_tiles_once(const SnapshotSource& snapshots, const std::stop_token& stop);

  ReconstructOptions options_;
  std::filesystem::path spool_folder_;
  std::optional<TilePlan> plan_ = {};
  std::size_t added_ = 0;  // snapshots
  std::shared_ptr<UnnamedFile> spool_ = {};
  std::vector<StoredTile> made_ = {};  // all of the plan, or none
};

}  // namespace octurn
