#include "store/job.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace octurn {
namespace {

template <typename Value>
using Names = std::pair<Value, std::string_view>;

constexpr std::array<Names<JobState>, 6> states{{{JobState::running, "running"},
                                                 {JobState::paused, "paused"},
                                                 {JobState::finished, "finished"},
                                                 {JobState::cancelled, "cancelled"},
                                                 {JobState::failed, "failed"},
                                                 {JobState::interrupted, "interrupted"}}};

constexpr std::array<Names<Phase>, 8> phases{{{Phase::starting, "starting"},
                                              {Phase::turning, "turning"},
                                              {Phase::capturing, "capturing"},
                                              {Phase::calibrating, "calibrating"},
                                              {Phase::rebuilding, "rebuilding"},
                                              {Phase::registering, "registering"},
                                              {Phase::building, "building"},
                                              {Phase::done, "done"}}};

template <typename Value, std::size_t size>
std::optional<Value> named(std::string_view name, const std::array<Names<Value>, size>& names) {
  const auto* found = std::ranges::find(names, name, &Names<Value>::second);
  return found == names.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace

bool is_resumable(JobState state) {
  return state == JobState::paused || state == JobState::interrupted;
}

std::string_view to_string(JobState state) {
  return std::ranges::find(states, state, &Names<JobState>::first)->second;
}

std::string_view to_string(Phase phase) {
  return std::ranges::find(phases, phase, &Names<Phase>::first)->second;
}

std::optional<JobState> job_state_named(std::string_view name) { return named(name, states); }

std::optional<Phase> phase_named(std::string_view name) { return named(name, phases); }

Failure interruption() {
  return {.code = ErrorCode::interrupted,
          .detail = "the scanner was switched off during this scan",
          .hint = "Resume it if neither the object nor the platform was moved since."};
}

bool has_pose(const Build& build, const std::string& pose) {
  return std::ranges::find(build.poses, pose) != build.poses.end();
}

const Build* find_build(const Job& job, int number) {
  const auto found = std::ranges::find(job.builds.all, number, &Build::number);
  return found == job.builds.all.end() ? nullptr : &*found;
}

const Model* chosen_model(const Job& job) {
  if (const Build* const build = find_build(job, job.builds.chosen)) {
    return &build->model;
  }
  return job.model ? &*job.model : nullptr;
}

Job with_stored_changes(Job working, const Job& stored) {
  working.label = stored.label;
  working.builds.all = stored.builds.all;
  working.builds.chosen = stored.builds.chosen;
  return working;
}

Job to_interrupted(Job job, int snapshots, const Failure& reason) {
  job.state = JobState::interrupted;
  job.phase = Phase::done;
  job.snapshots_done = snapshots;
  job.times.left.reset();
  job.times.until_pause.reset();
  job.failure = reason;
  return job;
}

}  // namespace octurn
