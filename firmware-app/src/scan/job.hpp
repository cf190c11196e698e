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

/// What a scan is doing.
enum class Phase {
  starting,
  turning,
  capturing,
  calibrating,  ///< solving the sensor's pose from the snapshots
  rebuilding,   ///< adding the stored snapshots with another pose than while the platform turned
  registering,  ///< finding out how the object was turned over
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

/// Why a scan has no model whose daemon ended while it ran.
Failure interruption();

/// A finished model, and how long it took once the last snapshot was stored.
struct Model {
  ModelReport report = {};
  std::chrono::duration<double> build_time = {};
  std::optional<Quality> quality = {};  ///< none of a model that an earlier version has made
};

/// What a scan's own snapshots told of the sensor's pose.
struct ScanCalibration {
  bool accepted = false;
  bool confirms_told = false;             ///< the told pose is right, and stays
  std::string reason = {};                ///< why what was solved is refused, or empty
  std::optional<SolvedPose> solved = {};  ///< if accepted
  std::vector<CalibrationFinding> findings = {};
  int rebuilt = 0;  ///< snapshots of which the model is built again, so far
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
  int replaced = 0;  ///< of a build that a scan of another pose made: the one chosen before it
};

/// How a turn fits together with those before it.
struct PoseRegistration {
  bool accepted = false;
  std::string reason = {};                             ///< why not, for people; empty if accepted
  RegisteredPose pose = {};                            ///< of the turn, if accepted
  std::vector<RegistrationCandidate> candidates = {};  ///< to choose from, the best first
  /// From which of them the pose was refined; nothing: from pairs of points, or it does not fit.
  std::optional<std::size_t> candidate = {};
};

/// What a scan is that has the object of another scan lie otherwise.
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
  int late_pulses = 0;  ///< of the motor, which turned more slowly for it
};

/// The builds of a scan.
struct JobBuilds {
  std::vector<Build> all = {};  ///< in order of their numbers
  int chosen = 0;               ///< whose model is the scan's; 0: what the scan itself made
  bool have_colours = false;    ///< if asked for: the scan's pictures do, of a scan by laser line
};

/// What a person wrote on a scan; empty if nobody did.
struct ScanLabel {
  std::string name = {};
  std::string notes = {};
};

/// One scan: what was asked for, and what has become of it.
struct Job {
  std::string id = {};
  ScanLabel label = {};
  JobState state = JobState::running;
  Phase phase = Phase::starting;
  int snapshots_done = 0;
  JobTimes times = {};
  ScanSettings settings = {};
  std::optional<Failure> failure = {};  ///< of a running scan: what is being tried again
  std::optional<ScanCalibration> calibration = {};  ///< from the last stop on, unless told
  std::optional<Model> model = {};                  ///< that the scan itself made
  JobBuilds builds = {};
  std::optional<PoseOf> pose_of = {};  ///< of a scan of another pose
};

/// The build of that number; null if there is none.
const Build* find_build(const Job& job, int number);

/// The scan's model: that of the build that was chosen. Null if there is none.
const Model* chosen_model(const Job& job);

/// A scan that ended with the program, or whose end could not be written down: it can go on.
/// @param snapshots  that are stored
Job to_interrupted(Job job, int snapshots);

}  // namespace octurn
