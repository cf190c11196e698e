// Worker: merging a scan of another pose with the first scan of its object.

#include <utility>

#include "build/merged_model.hpp"
#include "build/pose_points.hpp"
#include "capture/scan_of_rig.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "run/worker.hpp"

namespace octurn {

namespace {

PoseRegistration to_pose_registration(const Registration& registration) {
  PoseRegistration found{.accepted = registration.accepted,
                         .reason = registration.reason,
                         .candidates = registration.candidates};
  if (registration.accepted) {
    found.pose = registration.poses.back();
    found.candidate = 0;
  }
  return found;
}

}  // namespace

/// Checks that a scan of another pose uses the first scan's sensor: only turns of one sensor are
/// registered.
void Worker::expect_same_sensor() {
  if (!job_.pose_of) {
    return;
  }
  const Scan first = read_scan(ports_.store.folder(job_.pose_of->scan));
  if (!has_sensor_of(first, job_.settings, rig_)) {
    throw Error(ErrorCode::sensor_other,
                "the scan of the first pose was made with another sensor: " + first.sensor_name,
                "Plug in the one that it was made with.", {{"first_pose_with", first.sensor_name}});
  }
}

void Worker::show_join(Phase phase) {
  job_.phase = phase;
  ports_.board.set_job(job_);
  begin(phase);
}

/// Registers a scan of another pose with the turns before it, and builds one model of all of them,
/// which becomes the first scan's. If the registration is refused, that model stays.
/// @return false if stopped first
bool Worker::join(const std::stop_token& stop) try {
  if (!job_.pose_of) {
    return true;
  }
  show_join(Phase::registering);
  ports_.store.withdraw_pose(job_.pose_of->scan, job_.id);  // of an earlier attempt
  const Job first = ports_.store.get(job_.pose_of->scan);
  std::vector<std::string> poses = merged_poses(first, job_.id);
  std::vector<StoredTurn> turns =
      read_turns({ports_.store.merged_scan(first.id, poses), ports_.store.folder(job_.id)});
  poses.push_back(job_.id);
  const Registration registration = register_turns(turns, limits_.threads, stop);
  write_pose_points(ports_.store.folder(job_.id), turns, registration.points);
  job_.pose_of->registration = to_pose_registration(registration);
  log::info("scanner", "scan " + job_.id + " as a pose of " + first.id + ": " +
                           (registration.accepted ? "it fits" : registration.reason));
  return !registration.accepted ||
         keep_merged(first, {.turns = turns, .registration = registration, .poses = poses}, stop);
} catch (const Stopped&) {
  return false;
}

/// Builds the model of all poses and makes it the first scan's. @return false if stopped first
bool Worker::keep_merged(const Job& first, const MergedTurns& merged, const std::stop_token& stop) {
  show_join(Phase::building);
  const int number = ports_.store.next_build(first.id);
  std::optional<Build> build =
      build_merged(ports_.store, first, merged, merged_settings(first, job_), number, limits_, stop,
                   [](Phase, int) {});
  if (!build) {
    ports_.store.drop_build(first.id, number);
    job_.pose_of->registration.reset();
    return false;
  }
  build->created = job_.times.created;
  build->replaced = ports_.store.get(first.id).builds.chosen;  // another may be chosen meanwhile
  ports_.store.add_build(first.id, *build);
  ports_.store.choose_build(first.id, number);
  return true;
}

}  // namespace octurn
