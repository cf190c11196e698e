#include "scan/model_stream.hpp"

#include <utility>

#include "octurn/model.hpp"
#include "octurn/stl_file.hpp"

namespace octurn {
namespace {

/// Leads out of a model that is no longer wanted.
struct Ended {};

ReconstructOptions clipped(ReconstructOptions options, const Box& clip) {
  options.clip = clip;
  return options;
}

}  // namespace

ModelStream::ModelStream(const std::filesystem::path& folder, ReconstructOptions options,
                         std::unique_ptr<Scanner::Leave> leave)
    : leave_(std::move(leave)),
      scan_(read_scan(folder)),
      snapshots_{.count = scan_.shots.size(),
                 .read = [this, folder](std::size_t shot) { return snapshot(folder, shot); }},
      reconstruction_(make_reconstructor(clipped(std::move(options), scan_.clip))) {
  try {
    reconstruction_->add(snapshots_);
    count_ = reconstruction_->count(snapshots_);
  } catch (const Ended&) {
    throw Error("busy", "a scan has started", "Wait for its end.");
  }
  expect_facets(count_);
}

Snapshot ModelStream::snapshot(const std::filesystem::path& folder, std::size_t shot) const {
  if (leave_->stop().stop_requested()) {
    throw Ended{};
  }
  return read_snapshot(folder, scan_, scan_.shots[shot]);
}

std::uint64_t ModelStream::bytes() const { return stl_bytes(count_.facets); }

void ModelStream::send(const std::function<bool(std::span<const std::byte>)>& sink) try {
  const auto hand_over = [&](std::span<const std::byte> bytes) {
    if (leave_->stop().stop_requested() || !sink(bytes)) {
      throw Ended{};
    }
  };
  hand_over(stl_header(count_.facets));
  reconstruction_->surface(
      snapshots_, [&](std::span<const Facet> facets) { hand_over(std::as_bytes(facets)); });
} catch (const Ended&) {
  return;
}

}  // namespace octurn
