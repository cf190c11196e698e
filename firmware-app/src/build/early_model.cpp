#include "build/early_model.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "log.hpp"
#include "octurn/units.hpp"
#include "settings/field.hpp"

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

namespace {

std::string mm_text(double metres) { return plain_text(rounded_mm(metres)) + " mm"; }

}  // namespace

FittingReconstruction::FittingReconstruction(const ReconstructOptions& options)
    : options_(options),
      asked_leaf_size_(options.leaf_size),
      reconstruction_(make_reconstructor(options)) {
  if (options.method != Method::solid) {
    return;
  }
  const MemoryNeed need = expected_memory(options);
  if (need.fitting_leaf_size > options.leaf_size) {
    log::warning("scan", "leaves of " + mm_text(options.leaf_size) + " take about " +
                             whole_mb_text(need.bytes) + ", of " +
                             whole_mb_text(options.memory_limit) + " that are allowed: those of " +
                             mm_text(need.fitting_leaf_size) + " would fit");
  }
}

void FittingReconstruction::start_again() {
  reconstruction_.reset();  // frees its memory for the next one
  reconstruction_ = make_reconstructor(options_);
}

void FittingReconstruction::start_again(const Box& clip) {
  options_.clip = clip;
  start_again();
}

void FittingReconstruction::make_coarser(const Error& error) {
  if (error.code() != ErrorCode::memory_limit || 2 * options_.leaf_size > options_.root_size) {
    throw error;
  }
  options_.leaf_size *= 2;
  log::warning("scan", detail());
  start_again();
}

void FittingReconstruction::add_coarser_reason(Quality& quality) const {
  if (options_.leaf_size > asked_leaf_size_) {
    quality.verdict = std::max(quality.verdict, Verdict::look);
    quality.reasons.push_back(
        {.code = std::string(coarser_code),
         .detail = detail(),
         .hint = "Allow more memory, or make the scanned space smaller, and build the model again.",
         .parameters = {{"asked_leaf_size_mm", mm_from_metres(asked_leaf_size_)},
                        {"leaf_size_mm", mm_from_metres(options_.leaf_size)}}});
  }
}

std::string FittingReconstruction::detail() const {
  return "leaves of " + mm_text(asked_leaf_size_) + " did not fit into " +
         whole_mb_text(options_.memory_limit) + ": the model has leaves of " +
         mm_text(options_.leaf_size);
}

}  // namespace octurn
