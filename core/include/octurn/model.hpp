#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/png.hpp"
#include "octurn/quality.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

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

/// The steps of `build_model`.
enum class BuildStep {
  calibrating,  ///< solving the sensor's pose
  adding,       ///< the snapshots
  writing,      ///< the surface
};

/// What a stored scan's model is built of, and how.
struct ModelInput {
  std::filesystem::path folder = {};  ///< of the scan
  Scan scan = {};                     ///< with the configured pose and the sensor map of the model
  ReconstructOptions options = {};    ///< `build_model` adapts them by `fit_to_scan`
  /// Whether the sensor's pose is solved for a scan of one turn that has no solved one.
  bool solves_pose = true;
  bool is_judged = true;
  /// Of the calibration that gave the scan its solved pose; replaced if a pose is solved here.
  std::vector<CalibrationFinding> findings = {};
  std::optional<SolvedOptics> seen_optics = {};  ///< the same, for `expected_size_error`
  std::filesystem::path spool = {};              ///< as in `make_tiled_reconstructor`
  /// Reads the snapshots of the scan, before and after its pose is solved.
  std::function<SnapshotSource(const Scan& scan)> snapshots = {};
  /// Writes the surface, as `write_model` does. @return nothing if stopped, or if it is not
  /// measured
  std::function<std::optional<ModelReport>(Reconstructor& reconstructor,
                                           const SnapshotSource& snapshots)>
      write = {};
  /// Called on any thread at the begin of each step, and for each snapshot that is added.
  std::function<void(BuildStep step, int snapshots)> progress = [](BuildStep, int) {};
};

/// A model as `build_model` made it.
struct BuiltModel {
  Scan scan = {};                                     ///< with the pose that it was made with
  std::optional<CalibrationReport> calibration = {};  ///< if the pose was solved for it
  std::optional<ModelReport> report = {};             ///< if it was measured
  /// If it was measured, the scan is on a platform, and the model is not edited.
  std::optional<Quality> quality = {};
};

/// Builds the model of a stored scan: solves the sensor's pose, reconstructs the surface by the
/// options' method, writes it, and judges it. A scan with free poses is made tile by tile.
/// @throws Stopped  if stopped before the model was written
/// @throws Error    as `solve_scan`, `make_reconstructor`, `Reconstructor::add`, and the functions
///                  of the input
BuiltModel build_model(ModelInput input, const std::stop_token& stop);

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
