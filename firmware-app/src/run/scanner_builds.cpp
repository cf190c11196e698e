// Scanner: builds of stored scans, and models and colours for HTTP requests.

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include "build/colour_model.hpp"
#include "run/rebuild.hpp"
#include "run/scanner.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

constexpr auto model_patience = std::chrono::seconds(5);  // maximum wait for another request

/// Whether a scan has all its snapshots, but no model yet.
bool waits_for_model(const Job& job) {
  return job.state == JobState::interrupted && job.snapshots_done == job.settings.snapshots;
}

}  // namespace

std::optional<BuildRun> Scanner::build(std::string_view id, const BuildOrder& order) {
  const std::lock_guard lock(scans_);
  const Job job = store_.get(id);
  if (job.state == JobState::running ||
      (is_resumable(job.state) && !(slurm_ && waits_for_model(job)))) {
    throw Error(ErrorCode::busy, "this scan has not ended", "Wait for its end, or end it.");
  }
  if (job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  BuildRun run{.scan = job.id, .snapshots = job.snapshots_done, .settings = order.settings};
  return slurm_ ? slurm_->add(std::move(run), order.becomes_model)
                : offer_build({.run = std::move(run), .becomes_model = order.becomes_model});
}

/// `scans_` is held.
std::optional<BuildRun> Scanner::offer_build(BuildCommand command) {
  store_.make_room(max_model_bytes(), "a model");
  if (slot_.is_busy() || slot_.has_ended()) {
    return std::nullopt;
  }
  BuildRun& run = command.run;
  run.number = store_.next_build(run.scan);
  run.created = utc_text(std::chrono::system_clock::now(), rfc3339);
  board_.set_build_run(run);
  if (!slot_.offer_build(command)) {
    board_.drop_waiting_build({});  // the scanner is ending
    return std::nullopt;
  }
  return run;
}

bool Scanner::cancel_build(std::string_view id, int number) {
  if (slurm_ && slurm_->cancel(id, number)) {
    return true;
  }
  const std::lock_guard lock(scans_);
  if (!slot_.has_build(id, number)) {
    return false;
  }
  if (slot_.stop_build()) {
    board_.drop_waiting_build({});
  }
  return true;
}

bool Scanner::is_building(std::string_view id) const {
  return slot_.has_build(id) || (slurm_ && slurm_->is_building(id));
}

std::vector<BuildRun> Scanner::build_runs() const {
  std::vector<BuildRun> runs;
  if (const auto run = build_run(); *run) {
    runs.push_back(**run);
  }
  if (const auto elsewhere = slurm_runs()) {
    runs.insert(runs.end(), elsewhere->begin(), elsewhere->end());
  }
  return runs;
}

std::unique_ptr<ModelStream> Scanner::stream_model(std::string_view id,
                                                   const ReconstructOptions& options) {
  return make_for_request([folder = store_.folder(id), options](ModelPipe& pipe) {
    make_model(folder, options, pipe);
  });
}

bool Scanner::colour_model(const Job& job, int build) {
  const auto make = [job, build, this](ModelPipe& pipe) {
    octurn::colour_model(store_.model_file(job.id, build), scan_of_model(store_, job, build),
                         limits_.memory_bytes, pipe.stop().get_token());
    pipe.set_length(0);
    pipe.close();
  };
  return make_for_request(make) != nullptr;
}

/// @return null while a scan or a build runs, or if another request takes too long
/// @throws Error  that `make` throws before it sets the pipe's length
std::unique_ptr<ModelStream> Scanner::make_for_request(std::function<void(ModelPipe& pipe)> make) {
  const auto pipe = std::make_shared<ModelPipe>();
  return slot_.offer_rebuild({.make = std::move(make), .pipe = pipe}, pipe->stop(), model_patience)
             ? std::make_unique<ModelStream>(pipe)
             : nullptr;
}

}  // namespace octurn
