#include "scan/early_model.hpp"

#include <span>
#include <utility>

namespace octurn {

void EarlyModel::begin(Reconstructor& reconstructor, SnapshotSource snapshots,
                       const std::filesystem::path& file) {
  stop_ = std::stop_source();
  check_ = MeshCheck();
  file_.emplace(file);
  count_ = std::async(std::launch::async, [this, &reconstructor, stored = std::move(snapshots)] {
    const auto write = [this](std::span<const Facet> facets) {
      check_.add(facets);
      file_->write(facets);
    };
    return write_model(reconstructor, stored, write, stop_.get_token());
  });
}

std::optional<ModelReport> EarlyModel::finish(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { stop_.request_stop(); });
  const std::optional<SurfaceCount> count = count_.get();
  if (!count) {
    return std::nullopt;
  }
  file_->commit();
  file_.reset();
  return report_of(*count, check_);
}

void EarlyModel::give_up() {
  stop_.request_stop();
  if (count_.valid()) {
    count_.wait();
    count_ = {};  // with what it may have thrown
  }
  file_.reset();
}

}  // namespace octurn
