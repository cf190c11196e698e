// Worker: builds of stored scans.

#include <utility>

#include "build/build_task.hpp"
#include "build/merged_model.hpp"
#include "log.hpp"
#include "run/worker.hpp"

namespace octurn {
namespace {

/// Builds the model into the build's folder, and adds it to the store.
/// @return false if stopped first
bool build_and_keep(const BuildCommand& command, const Limits& limits, const WorkerPorts& ports,
                    const std::stop_token& stop) {
  const BuildRun& run = command.run;
  const auto show = [&](Phase phase, int done) {
    BuildRun now = run;
    now.phase = phase;
    now.snapshots_done = done;
    ports.board.set_build_run(std::move(now));
  };
  if (command.pose) {
    return refit_pose(ports.store, run, *command.pose, limits, stop, show);
  }
  const std::filesystem::path file = ports.store.begin_build(run.scan, run.number);
  const BuildTask task = make_task(ports.store, run, command.becomes_model);
  const std::optional<Build> build = build_model(task, limits, file, stop, show);
  if (!build) {
    return false;
  }
  ports.store.add_build(run.scan, *build);
  choose_built(ports.store, task);
  return true;
}

}  // namespace

void Worker::carry_out(BuildCommand& command, const std::stop_source& stop) {
  ports_.heartbeat.suspend();  // a model may take minutes
  BuildRun& run = command.run;
  const std::string name = describe(run);
  run.state = BuildRun::State::running;
  ports_.board.set_build_run(run);
  log::info("scanner", name + " started");
  try {
    run.state = build_and_keep(command, limits_, ports_, stop.get_token())
                    ? BuildRun::State::finished
                    : BuildRun::State::cancelled;
  } catch (...) {
    run.state = BuildRun::State::failed;
    run.failure = current_failure();
    log::error("scanner", name + ": " + run.failure->detail);
  }
  ports_.store.drop_build(run.scan, run.number);
  run.phase = Phase::done;
  const std::lock_guard lock(ports_.scans);
  if (run.state == BuildRun::State::cancelled && ports_.slot.has_scan()) {
    run.failure = displaced_by_scan();
  }
  log::info("scanner", name + " " + std::string(to_string(run.state)));
  ports_.slot.finish();  // frees the slot before clients see the end
  ports_.board.set_build_run(run);
}

}  // namespace octurn
