#include <span>

#include "mesh/mesh_check.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/stl.hpp"
#include "octurn/tiles.hpp"

namespace octurn {
namespace {

/// Streams a surface to `sink`, and measures it on the way.
/// @param surface  streams all facets to the sink that it is called with, and counts them
template <typename Surface>
ModelReport measured(const Surface& surface, const FacetSink& sink) {
  MeshCheck check;
  const SurfaceCount count = surface([&](std::span<const Facet> facets) {
    check.add(facets);
    sink(facets);
  });
  expect_facets(count);
  return make_report(count, check);
}

template <typename Surface>
ModelReport write_stl(const Surface& surface, const std::filesystem::path& file) {
  StlFile stl(file);
  const ModelReport report =
      measured(surface, [&](std::span<const Facet> facets) { stl.write(facets); });
  stl.commit();
  return report;
}

}  // namespace

void expect_facets(const SurfaceCount& count) {
  if (count.facets == 0) {
    throw Error(ErrorCode::model_empty, "no surface in the clip box: there is nothing to write",
                "Stand the object on the platform's middle, and check the scanned space and the "
                "calibration.");
  }
}

std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots, const FacetSink& sink,
                                       const std::stop_token& stop) try {
  return measured(
      [&](const FacetSink& take) { return reconstructor.surface(snapshots, take, stop); }, sink);
} catch (const Stopped&) {
  return std::nullopt;
}

std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop) try {
  return write_stl(
      [&](const FacetSink& take) { return reconstructor.surface(snapshots, take, stop); }, file);
} catch (const Stopped&) {
  return std::nullopt;
}

ModelReport join_tiles(std::span<const std::filesystem::path> files,
                       const std::filesystem::path& model, const std::stop_token& stop) {
  return write_stl([&](const FacetSink& take) { return join_tiles(files, take, stop); }, model);
}

}  // namespace octurn
