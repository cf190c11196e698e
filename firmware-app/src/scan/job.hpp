#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/model.hpp"
#include "octurn/quality.hpp"
#include "octurn/register.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/build_settings.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

enum class JobState {
  running,
  paused,  ///< a device failed for too long
  finished,
  cancelled,
  failed,
  interrupted,  ///< the daemon ended while it ran
};

/// The current step of a scan.
enum class Phase {
  starting,
  turning,
  capturing,
  calibrating,  ///< solving the sensor's pose from the snapshots
  rebuilding,   ///< adding the stored snapshots again, with the solved pose
  registering,  ///< finding the object's pose after it was turned over
  building,
  done,
};

/// Whether a scan in that state waits to go on where it stopped.
bool is_resumable(JobState state);

std::string_view to_string(JobState state);
std::string_view to_string(Phase phase);

/// The state or phase of that name, if there is one.
std::optional<JobState> job_state_named(std::string_view name);
std::optional<Phase> phase_named(std::string_view name);

/// The failure of a scan during which the daemon ended.
Failure interruption();

/// A finished model, and how long it took once the last snapshot was stored.
struct Model {
  ModelReport report = {};
  std::chrono::duration<double> build_time = {};
  std::optional<Quality> quality = {};  ///< none of a model that an earlier version has made
};

/// The sensor's pose as solved from a scan's own snapshots.
struct ScanCalibration {
  bool accepted = false;
  bool confirms_told = false;             ///< the told pose is right, and stays
  std::string reason = {};                ///< why the solved pose was refused, or empty
  std::optional<SolvedPose> solved = {};  ///< if accepted
  std::vector<CalibrationFinding> findings = {};
  int rebuilt = 0;  ///< snapshots added again so far
};

ScanCalibration to_scan_calibration(const CalibrationReport& report);

/// A model that was built from the stored snapshots, with other settings than the scan's.
struct Build {
  int number = 1;            ///< among the scan's builds, from 1
  std::string created = {};  ///< UTC, as in ISO 8601
  BuildSettings settings = {};
  std::optional<ScanCalibration> calibration = {};  ///< if the pose was solved for it
  Model model = {};
  std::vector<std::string> poses = {};  ///< ids of the scans of other poses that are in it
  int replaced = 0;  ///< of a build for another pose: the build that was chosen before it
};

/// Result of registering a turn with those before it.
struct PoseRegistration {
  bool accepted = false;
  std::string reason = {};   ///< why it was refused, for people; empty if accepted
  RegisteredPose pose = {};  ///< of the turn, if accepted
  std::vector<RegistrationCandidate> candidates = {};  ///< to choose from, the best first
  /// Index of the candidate that was refined; nothing: refined from pairs of points, or refused.
  std::optional<std::size_t> candidate = {};
};

/// Links a scan to an earlier scan of the same object in another pose.
struct PoseOf {
  std::string scan = {};                              ///< id of the other one
  std::optional<PoseRegistration> registration = {};  ///< once all snapshots are taken
};

/// When a scan was begun, and how long it takes.
struct JobTimes {
  std::string created = {};  ///< UTC, as in ISO 8601
  std::chrono::duration<double> elapsed = {};
  std::optional<std::chrono::duration<double>> left = {};  ///< expected, from what happened so far
  /// Of a running scan at a stop where a device fails: how long it still tries that stop again.
  std::optional<std::chrono::duration<double>> until_pause = {};
  int late_pulses = 0;  ///< of the motor, which slowed the turn
};

/// The builds of a scan.
struct JobBuilds {
  std::vector<Build> all = {};  ///< in order of their numbers
  int chosen = 0;               ///< number of the build whose model is shown; 0: the scan's own
  bool have_colours = false;    ///< if asked for: the scan's pictures do, of a scan by laser line
};

/// A person's name and notes for a scan; empty if there are none.
struct ScanLabel {
  std::string name = {};
  std::string notes = {};
};

/// One scan: its settings, state and results.
struct Job {
  std::string id = {};
  ScanLabel label = {};
  JobState state = JobState::running;
  Phase phase = Phase::starting;
  int snapshots_done = 0;
  JobTimes times = {};
  ScanSettings settings = {};
  std::optional<Failure> failure = {};  ///< of a running scan: the fault that is being retried
  std::optional<ScanCalibration> calibration = {};  ///< from the last stop on, unless told
  std::optional<Model> model = {};                  ///< made by the scan itself
  JobBuilds builds = {};
  std::optional<PoseOf> pose_of = {};  ///< of a scan of another pose
};

/// The build of that number; null if there is none.
const Build* find_build(const Job& job, int number);

/// The model of the chosen build; null if there is none.
const Model* chosen_model(const Job& job);

/// Marks a scan as interrupted, because the program ended or its outcome could not be saved: it can
/// be resumed.
/// @param snapshots  number of stored ones
Job to_interrupted(Job job, int snapshots);

}  // namespace octurn
