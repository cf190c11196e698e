#include "scan/model_stream.hpp"

#include <utility>

#include "octurn/mesh_report.hpp"
#include "octurn/stl.hpp"

namespace octurn {
namespace {

ReconstructOptions clipped(ReconstructOptions options, const Box& clip) {
  options.clip = clip;
  return options;
}

}  // namespace

ModelStream::ModelStream(const std::filesystem::path& folder, ReconstructOptions options,
                         std::unique_ptr<Scanner::Leave> leave)
    : leave_(std::move(leave)),
      scan_(read_scan(folder)),
      snapshots_(stored_snapshots(folder, scan_, leave_->stop())),
      reconstruction_(make_reconstructor(clipped(std::move(options), scan_.clip))) {
  try {
    reconstruction_->add(snapshots_, stop());
    count_ = reconstruction_->count(snapshots_, stop());
  } catch (const Stopped&) {
    throw Error("busy", "a scan has started", "Wait for its end.");
  }
  expect_facets(count_);
}

std::uint64_t ModelStream::bytes() const { return stl_bytes(count_.facets); }

void ModelStream::send(const std::function<bool(std::span<const std::byte>)>& sink) try {
  const auto hand_over = [&](std::span<const std::byte> bytes) {
    if (leave_->stop().stop_requested() || !sink(bytes)) {
      throw Stopped{};
    }
  };
  hand_over(stl_header(count_.facets));
  write_model(
      *reconstruction_, snapshots_,
      [&](std::span<const Facet> facets) { hand_over(std::as_bytes(facets)); }, leave_->stop());
} catch (const Stopped&) {
  return;
}

}  // namespace octurn
