#include "octurn/model.hpp"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>

#include "mesh/mesh_check.hpp"
#include "octurn/error.hpp"
#include "octurn/stl.hpp"
#include "octurn/tiles.hpp"
#include "octurn/units.hpp"

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

/// Reports the number of snapshots read so far.
SnapshotSource counted(SnapshotSource snapshots,
                       const std::function<void(BuildStep, int)>& progress) {
  const auto done = std::make_shared<std::atomic<int>>(0);
  const auto count = static_cast<int>(snapshots.count);
  return {.count = snapshots.count,
          .read = [done, count, progress, read = std::move(snapshots.read)](std::size_t index) {
            Snapshot snapshot = read(index);
            progress(BuildStep::adding, std::min(++*done, count));
            return snapshot;
          }};
}

/// A reconstruction whose surface is laid and scaled.
class PlacedReconstructor final : public Reconstructor {
 public:
  PlacedReconstructor(std::unique_ptr<Reconstructor> object, const ModelEdits& edits)
      : object_(std::move(object)), model_from_object_(model_from_object(edits)) {}

  void add(const Snapshot& snapshot, const std::stop_token& stop) override {
    object_->add(snapshot, stop);
  }
  void add(const SnapshotSource& snapshots, const std::stop_token& stop) override {
    object_->add(snapshots, stop);
  }
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                       const std::stop_token& stop) override {
    std::vector<Facet> placed;
    return object_->surface(
        snapshots,
        [&](std::span<const Facet> facets) {
          placed.assign(facets.begin(), facets.end());
          std::ranges::for_each(placed, [this](Facet& facet) { place(facet); });
          sink(placed);
        },
        stop);
  }
  SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop) override {
    return object_->count(snapshots, stop);
  }
  void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
               const std::stop_token& stop) const override {
    object_->preview(leaf_size, max_facets, sink, stop);
  }

 private:
  /// Facets' members are not aligned, so they are copied.
  void place(Facet& facet) const {
    facet.normal = floats((model_from_object_.linear() * vector(facet.normal)).normalized());
    auto corners = facet.corners;
    for (auto& corner : corners) {
      corner =
          floats(mm_from_metres(1) * (model_from_object_ * (metres_from_mm(1) * vector(corner))));
    }
    facet.corners = corners;
  }

  static Eigen::Vector3d vector(std::array<float, 3> from) {
    return Eigen::Map<const Eigen::Vector3f>(from.data()).cast<double>();
  }
  static std::array<float, 3> floats(const Eigen::Vector3d& from) {
    return {static_cast<float>(from.x()), static_cast<float>(from.y()),
            static_cast<float>(from.z())};
  }

  std::unique_ptr<Reconstructor> object_;
  Eigen::Affine3d model_from_object_;
};

std::unique_ptr<Reconstructor> make_model_reconstructor(const ModelInput& input, bool is_tiled) {
  const ReconstructOptions& options = input.options;
  auto object =
      is_tiled ? make_tiled_reconstructor(options, input.spool) : make_reconstructor(options);
  if (options.edits.move()) {
    return std::make_unique<PlacedReconstructor>(std::move(object), options.edits);
  }
  return object;
}

/// Solves the scan's pose if it has none that is solved, and finds how the object moved.
void find_faults(ModelInput& input, BuiltModel& model, const std::stop_token& stop) {
  Scan& scan = model.scan;
  if (input.solves_pose && !scan.solved && is_one_turn(scan)) {
    input.progress(BuildStep::calibrating, 0);
    ScanSolution solution =
        solve_scan(input.folder, scan, input.snapshots(scan), input.options.threads, stop);
    throw_if_stopped(stop);
    take_solution(scan, solution);
    input.findings = solution.report.findings;
    input.seen_optics = solution.report.optics;
    model.calibration = std::move(solution.report);
  }
  if (const auto move = read_object_move(input.folder)) {
    add_move(input.findings, *move);
  }
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

BuiltModel build_model(ModelInput input, const std::stop_token& stop) {
  BuiltModel model{.scan = std::move(input.scan)};
  const Scan& scan = model.scan;
  find_faults(input, model, stop);
  const ReconstructOptions& options = input.options;
  fit_to_scan(input.options, scan);
  const bool is_tiled = has_free_poses(scan);
  const auto reconstructor = make_model_reconstructor(input, is_tiled);
  std::optional<PoseChecks> checks;
  SnapshotSource stored = input.snapshots(scan);
  SnapshotSource added = counted(stored, input.progress);
  if (input.is_judged && !is_tiled && options.edits == ModelEdits{}) {
    checks.emplace(options.placements, options.clip, scan.shots.size(), sensor_traits(scan));
    added = checked_snapshots(std::move(added), *checks);
  }
  input.progress(BuildStep::adding, 0);
  reconstructor->add(added, stop);
  input.progress(BuildStep::writing, static_cast<int>(stored.count));
  try {
    model.report = input.write(*reconstructor, stored);
  } catch (const Error& error) {
    if (checks) {
      expect_higher_object(error, *checks);
    }
    throw;
  }
  if (!model.report) {
    throw_if_stopped(stop);
  } else if (checks) {
    model.quality =
        judge(*checks, options.threads, scan, *model.report, input.findings, input.seen_optics);
  }
  return model;
}

}  // namespace octurn
