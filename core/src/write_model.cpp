#include <algorithm>
#include <span>

#include "octurn/error.hpp"
#include "octurn/mesh_report.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"

namespace octurn {

void expect_facets(const SurfaceCount& count) {
  if (count.facets == 0) {
    throw Error(ErrorCode::model_empty, "no surface in the clip box: there is nothing to write",
                "Stand the object on the platform's middle, and check the scanned space and the "
                "calibration.");
  }
}

ModelReport report_of(const SurfaceCount& count, const MeshCheck& check) {
  const Eigen::Vector3d size_mm = check.bounds_mm().max - check.bounds_mm().min;
  const double volume = m3_from_mm3(check.volume_mm3());
  return {.leaves = count.leaves,
          .triangles = count.facets,
          .bytes = stl_bytes(count.facets),
          .parts = count.parts,
          .filled_share = check.filled_share(),
          .unseen_share = check.unseen_share(),
          .places = {.unseen = check.unseen_places(), .surface = check.surface()},
          .watertight = check.closed(),
          .volume = volume,
          .dropped = {.count = count.dropped_parts,
                      .volume = volume * static_cast<double>(count.dropped_leaves) /
                                static_cast<double>(std::max<std::uint64_t>(count.leaves, 1))},
          .size = {metres_from_mm(size_mm.x()), metres_from_mm(size_mm.y()),
                   metres_from_mm(size_mm.z())},
          .bottom = metres_from_mm(check.bounds_mm().min.z())};
}

std::optional<SurfaceCount> write_model(Reconstructor& reconstructor,
                                        const SnapshotSource& snapshots, const FacetSink& sink,
                                        const std::stop_token& stop) try {
  const SurfaceCount count = reconstructor.surface(snapshots, sink, stop);
  expect_facets(count);
  return count;
} catch (const Stopped&) {
  return std::nullopt;
}

std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop) {
  StlFile stl(file);
  MeshCheck check;
  const auto checked = [&](std::span<const Facet> facets) {
    check.add(facets);
    stl.write(facets);
  };
  const auto count = write_model(reconstructor, snapshots, checked, stop);
  if (!count) {
    return std::nullopt;
  }
  stl.commit();
  return report_of(*count, check);
}

}  // namespace octurn
