#include "octurn/model.hpp"

#include <span>

#include "octurn/error.hpp"
#include "octurn/stl_file.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

struct Stopped {};

}  // namespace

void expect_facets(const SurfaceCount& count) {
  if (count.facets == 0) {
    throw Error("model-empty", "no surface in the clip box: there is nothing to write",
                "Check that the object stands on the platform, and the clip box and calibration.");
  }
}

ModelReport report_of(const SurfaceCount& count, const MeshCheck& check) {
  const Eigen::Vector3d size_mm = check.bounds_mm().max - check.bounds_mm().min;
  return {.leaves = count.leaves,
          .triangles = count.facets,
          .bytes = stl_bytes(count.facets),
          .parts = count.parts,
          .filled_share = check.filled_share(),
          .watertight = check.closed(),
          .volume = m3_from_mm3(check.volume_mm3()),
          .size = {metres_from_mm(size_mm.x()), metres_from_mm(size_mm.y()),
                   metres_from_mm(size_mm.z())}};
}

std::optional<ModelReport> write_model(Reconstructor& reconstruction,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop) try {
  StlFile stl(file);
  MeshCheck check;
  const SurfaceCount count = reconstruction.surface(snapshots, [&](std::span<const Facet> facets) {
    if (stop.stop_requested()) {
      throw Stopped{};
    }
    check.add(facets);
    stl.write(facets);
  });
  expect_facets(count);
  stl.commit();
  return report_of(count, check);
} catch (const Stopped&) {
  return std::nullopt;
}

}  // namespace octurn
