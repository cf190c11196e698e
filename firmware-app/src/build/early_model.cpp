#include "build/early_model.hpp"

#include <span>
#include <utility>

namespace octurn {

void EarlyModel::begin(Reconstructor& reconstructor, SnapshotSource snapshots,
                       const std::filesystem::path& file) {
  stop_ = std::stop_source();
  file_.emplace(file);
  report_ = std::async(std::launch::async, [this, &reconstructor, stored = std::move(snapshots)] {
    const auto write = [this](std::span<const Facet> facets) { file_->write(facets); };
    return write_model(reconstructor, stored, write, stop_.get_token());
  });
}

std::optional<ModelReport> EarlyModel::finish(const std::stop_token& stop) {
  const std::stop_callback end(stop, [this] { stop_.request_stop(); });
  std::optional<ModelReport> report = report_.get();
  if (report) {
    file_->commit();
  }
  file_.reset();
  return report;
}

void EarlyModel::give_up() {
  stop_.request_stop();
  if (report_.valid()) {
    report_.wait();
    report_ = {};  // drops a stored exception
  }
  file_.reset();
}

}  // namespace octurn
