// How a scanner takes builds of stored scans.

#include <chrono>
#include <mutex>

#include "scan/scanner.hpp"
#include "utc.hpp"

namespace octurn {

std::optional<BuildRun> Scanner::build(std::string_view id, const BuildOrder& order) {
  const std::lock_guard lock(scans_);
  const Job job = store_.get(id);
  if (job.state == JobState::running || is_resumable(job.state)) {
    throw Error(ErrorCode::busy, "this scan has not ended", "Wait for its end, or end it.");
  }
  if (job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  return offer_build(
      {.run = {.scan = job.id, .snapshots = job.snapshots_done, .settings = order.settings},
       .becomes_model = order.becomes_model});
}

/// `scans_` is held.
std::optional<BuildRun> Scanner::offer_build(BuildCommand command) {
  store_.make_room(max_model_bytes(), "a model");
  const auto last = build_run();
  if (slot_.has_scan() || slot_.has_ended() || (*last && !(*last)->has_ended())) {
    return std::nullopt;
  }
  BuildRun& run = command.run;
  run.number = store_.next_build(run.scan);
  run.created = utc_text(std::chrono::system_clock::now(), rfc3339);
  board_.set_build_run(run);
  if (!slot_.offer_build(command)) {
    board_.drop_waiting_build({});  // this is ending
    return std::nullopt;
  }
  return run;
}

bool Scanner::cancel_build(std::string_view id, int number) {
  const std::lock_guard lock(scans_);
  const auto run = build_run();
  if (!is_building(id) || (*run)->number != number) {
    return false;
  }
  if (slot_.stop_build()) {
    board_.drop_waiting_build({});
  }
  return true;
}

bool Scanner::is_building(std::string_view id) const {
  const auto run = build_run();
  return *run && !(*run)->has_ended() && (*run)->scan == id;
}

}  // namespace octurn
