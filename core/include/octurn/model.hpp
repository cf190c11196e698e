#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

class SurfaceCells;

/// Coarse geometry of a model, for `judge`.
struct ModelPlaces {
  /// Metres, object's frame: where the surface above the base was made by hole filling.
  std::vector<Eigen::Vector3d> unseen = {};
  /// The cells of a grid that the surface passes through; null: no surface.
  std::shared_ptr<const SurfaceCells> surface = {};
};

/// Connected components that were seen but left out of a model.
struct DroppedParts {
  std::uint64_t count = 0;
  double volume = 0.0;  ///< cubic metres
};

/// The figures of a finished model.
struct ModelReport {
  std::uint64_t leaves = 0;  ///< occupied leaves; of the method `solid`, voxels inside
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;  ///< of the STL
  std::uint64_t parts = 0;  ///< connected components; 0: not counted
  double filled_share = 0;  ///< of the area, made by hole filling, 0 to 1
  double unseen_share = 0;  ///< the same without the base, the facets in z = 0
  ModelPlaces places = {};
  /// Whether the surface is closed. Of the method `solid` every directed edge is compared with its
  /// opposite, corners bit by bit; of `intersection` the sides of neighbouring bricks of leaves,
  /// inside which the surface is closed by construction. An open one is missed with a chance of
  /// 2^-64.
  bool watertight = false;
  double volume = 0.0;  ///< cubic metres; right only if watertight
  DroppedParts dropped = {};
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres, of the bounding box
  double bottom = 0.0;                             ///< metres, lowest z of that box
};

/// @throws Error "empty"  if there is no facet
void expect_facets(std::uint64_t facets);

/// Streams the surface to `sink`, and measures it on the way.
///
/// @param snapshots  those that were added
/// @return nothing if stopped before the end, by `stop` or by a `Stopped` of the source or sink
/// @throws Error "empty"  if there is no surface
/// @throws  as `Reconstructor::surface`
std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots, const FacetSink& sink,
                                       const std::stop_token& stop);

/// Writes the surface as binary STL, which appears whole or not at all.
///
/// @return nothing, and no file, if stopped before the end
/// @throws Error  as above; "disk-full", "write-failed" if the disk does not take the file
std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop);

/// A triangle mesh that shares its vertices.
struct VertexMesh {
  std::span<const std::array<float, 3>> vertices = {};  ///< millimetres, object's frame
  /// Indices of vertices, counter-clockwise seen from outside.
  std::span<const std::array<std::uint32_t, 3>> triangles = {};
};

/// Colours for a model's vertices, from the scan's pictures without laser light.
///
/// A vertex gets the mean colour of the pictures that see it, weighted by the squared cosine
/// between its normal and the direction to the camera. A vertex that no picture sees gets the mean
/// of its neighbours. At most 36 pictures of each pose are read; damaged ones are left out.
///
/// Pictures are exposed for the lasers, and therefore dark: all colours are multiplied by one
/// factor, at least 1, so that one in a hundred vertices has a level of 240 or more.
///
/// @param scan  by laser line, with the poses that the model was made with
/// @return one for each vertex; white in a connected part that no picture sees
/// @throws Error "scan-malformed"  if it is no scan by laser line, or a pose's
///                                 `object_from_platform` is unknown
/// @throws Stopped  once `stop` is requested
std::vector<Rgb> vertex_colours(const std::filesystem::path& folder, const Scan& scan,
                                const VertexMesh& mesh, const std::stop_token& stop = {});

}  // namespace octurn
