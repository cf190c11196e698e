#include <span>

#include "mesh/mesh_check.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/stl.hpp"
#include "octurn/tiles.hpp"

namespace octurn {
namespace {

/// Streams a surface to `sink`, and measures its facets on the way.
/// @param surface  streams all facets to the sink that it is called with, and counts them
template <typename Surface>
ModelReport measure_facets(const Surface& surface, const FacetSink& sink) {
  MeshCheck check;
  const SurfaceCount count = surface([&](std::span<const Facet> facets) {
    check.add(facets);
    sink(facets);
  });
  return make_report(count, check);
}

/// Writes the facets that `model` streams to the sink that it is called with, and reports.
template <typename Model>
ModelReport write_stl(const Model& model, const std::filesystem::path& file) {
  StlFile stl(file);
  ModelReport report = model([&](std::span<const Facet> facets) { stl.write(facets); });
  expect_facets(report.triangles);
  stl.commit();
  return report;
}

}  // namespace

void expect_facets(std::uint64_t facets) {
  if (facets == 0) {
    throw Error(ErrorCode::model_empty, "no surface in the clip box: there is nothing to write",
                "Stand the object on the platform's middle, and check the scanned space and the "
                "calibration.");
  }
}

ModelReport Reconstructor::measured_surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                            const std::stop_token& stop) {
  return measure_facets([&](const FacetSink& take) { return surface(snapshots, take, stop); },
                        sink);
}

std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots, const FacetSink& sink,
                                       const std::stop_token& stop) try {
  ModelReport report = reconstructor.measured_surface(snapshots, sink, stop);
  expect_facets(report.triangles);
  return report;
} catch (const Stopped&) {
  return std::nullopt;
}

std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop) try {
  return write_stl(
      [&](const FacetSink& sink) { return reconstructor.measured_surface(snapshots, sink, stop); },
      file);
} catch (const Stopped&) {
  return std::nullopt;
}

ModelReport join_tiles(std::span<const std::filesystem::path> files,
                       const std::filesystem::path& model, const std::stop_token& stop) {
  return write_stl(
      [&](const FacetSink& sink) {
        return measure_facets([&](const FacetSink& take) { return join_tiles(files, take, stop); },
                              sink);
      },
      model);
}

}  // namespace octurn
