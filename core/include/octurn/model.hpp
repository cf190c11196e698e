#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>

#include "octurn/mesh_check.hpp"
#include "octurn/reconstruct.hpp"

namespace octurn {

/// What a finished model is.
struct ModelReport {
  std::uint64_t leaves = 0;
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;
  std::uint64_t parts = 0;                         ///< 0: not counted
  double filled_share = 0;                         ///< of the surface's area, that nobody saw
  bool watertight = false;                         ///< every edge met by its opposite, as checked
  double volume = 0.0;                             ///< cubic metres
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres, of the box around it
};

/// @throws Error "model-empty"  if there is no facet
void expect_facets(const SurfaceCount& count);

/// What a surface is, that was counted and checked while it was made.
ModelReport report_of(const SurfaceCount& count, const MeshCheck& check);

/// Writes the surface as binary STL, which appears whole or not at all, and checks it on the way.
///
/// @return nothing, and no file, if stopped before the end
/// @throws Error "model-empty" if no triangle met the octree; if the disk does not take the file
std::optional<ModelReport> write_model(Reconstructor& reconstruction,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop);

}  // namespace octurn
