#include "octurn/reconstruct.hpp"

namespace octurn {
namespace {

std::variant<Intersection, Solid> method_of(const ReconstructOptions& options) {
  if (options.method == Method::solid) {
    return Solid(options);
  }
  return Intersection(options);
}

}  // namespace

Reconstruction::Reconstruction(const ReconstructOptions& options) : method_(method_of(options)) {}

void Reconstruction::add(const Snapshot& snapshot) {
  std::visit([&](auto& method) { method.add(snapshot); }, method_);
}

void Reconstruction::add(const SnapshotSource& snapshots, const std::stop_token& stop) {
  std::visit([&](auto& method) { method.add(snapshots, stop); }, method_);
}

SurfaceCount Reconstruction::surface(const SnapshotSource& snapshots, const FacetSink& sink) {
  return std::visit([&](auto& method) { return method.surface(snapshots, sink); }, method_);
}

SurfaceCount Reconstruction::count(const SnapshotSource& snapshots) {
  return std::visit([&](auto& method) { return method.count(snapshots); }, method_);
}

void Reconstruction::preview(double leaf_size, std::uint64_t most_facets,
                             const FacetSink& sink) const {
  std::visit([&](const auto& method) { method.preview(leaf_size, most_facets, sink); }, method_);
}

}  // namespace octurn
