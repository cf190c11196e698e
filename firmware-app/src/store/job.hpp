#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <ratio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/json_object.hpp"
#include "octurn/model.hpp"
#include "octurn/quality.hpp"
#include "octurn/register.hpp"
#include "octurn/scan_folder.hpp"
#include "settings/field.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// The settings of a build: the scan settings that need no new capture, and some of its own.
struct BuildSettings {
  ScanSettings scan = {};         ///< only the settings of `model_fields` are used
  std::optional<int> level = {};  ///< `intersection` only: draws the surface of this coarser level
  EditSettings edits = {};
  /// Sensor pose to use instead of the scan's: optical frame to platform frame, metres.
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
};

/// All these settings, each with its key, unit and range.
std::vector<Field> fields(BuildSettings& settings, const SettingRanges& ranges = requested_ranges);

nlohmann::json to_json(const BuildSettings& settings);

/// Reads the settings of a new build; a missing key has the value of `defaults`.
/// @throws Error "bad-settings"  with the key, its value and the allowed range; also for an unknown
///                               key
BuildSettings build_settings_from(const nlohmann::json& object, const BuildSettings& defaults);

/// Reads the settings of a stored build, with `stored_ranges`. @throws Error  as above, with the
/// code of `object`
BuildSettings stored_build_settings_from(const JsonValue& object);

using Seconds = std::chrono::duration<double>;

enum class JobState {
  running,
  paused,  ///< by a person, or because a device failed for too long
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

/// Whether a scan in that state waits to be resumed.
bool is_resumable(JobState state);

std::string_view to_string(JobState state);
std::string_view to_string(Phase phase);

/// The state or phase of that name; nullopt for other names.
std::optional<JobState> job_state_named(std::string_view name);
std::optional<Phase> phase_named(std::string_view name);

/// The failure of a scan that was running when the daemon ended.
Failure interruption();

/// A finished model. `build_time` counts from the last stored snapshot.
struct Model {
  ModelReport report = {};
  Seconds build_time = {};
  std::optional<Quality> quality = {};  ///< nullopt: made by an earlier version
};

/// The sensor's pose as solved from a scan's own snapshots.
struct ScanCalibration {
  bool accepted = false;
  bool confirms_told = false;               ///< the configured pose is right, and is kept
  std::string reason = {};                  ///< why the solved pose was refused, or empty
  std::optional<SolvedPose> solved = {};    ///< if accepted
  std::optional<SolvedOptics> optics = {};  ///< as measured, applied or not
  std::vector<CalibrationFinding> findings = {};
  int rebuilt = 0;  ///< snapshots added again so far, with the solved pose
};

/// Returns what a job stores of a report.
ScanCalibration to_scan_calibration(const CalibrationReport& report);

/// A model that was built from the stored snapshots, with other settings than the scan's.
struct Build {
  int number = 1;            ///< among the scan's builds, from 1
  std::string created = {};  ///< UTC, as in ISO 8601
  BuildSettings settings = {};
  std::optional<ScanCalibration> calibration = {};  ///< if the pose was solved for it
  Model model = {};
  std::vector<std::string> poses = {};  ///< ids of the scans of other poses that it merges
  int replaced = 0;  ///< if it merges poses: number of the build chosen before it
};

/// Whether a build merges the scan of another pose. @param pose  id of that scan
bool has_pose(const Build& build, const std::string& pose);

/// Result of registering a turn to the earlier ones.
struct PoseRegistration {
  bool accepted = false;
  std::string reason = {};   ///< why it was refused, for people; empty if accepted
  RegisteredPose pose = {};  ///< of the turn, if accepted
  std::vector<RegistrationCandidate> candidates = {};  ///< for a person to choose from, best first
  /// Index of the candidate that was refined; nullopt: refined from pairs of points, or refused.
  std::optional<std::size_t> candidate = {};
};

/// Links a scan to an earlier scan of the same object in another pose.
struct PoseOf {
  std::string scan = {};                              ///< id of the earlier scan
  std::optional<PoseRegistration> registration = {};  ///< once all snapshots are taken
  /// Of a pose that was removed from the earlier scan: number of the build with it that was chosen;
  /// 0 if none was.
  std::optional<int> removed_build = {};
};

/// When a scan was begun, and how long it takes.
struct JobTimes {
  std::string created = {};  ///< UTC, as in ISO 8601
  Seconds elapsed = {};
  std::optional<Seconds> left = {};  ///< estimated remaining time
  /// While a device fails at a stop of a running scan: time until the scan pauses.
  std::optional<Seconds> until_pause = {};
  int late_pulses = 0;    ///< motor pulses that came late, and slowed the turn
  int slips = 0;          ///< pictures that showed lost steps; their stops were taken again
  Seconds settling = {};  ///< that a stop waited at most for a platform that swung on
};

/// The builds of a scan.
struct JobBuilds {
  std::vector<Build> all = {};  ///< in order of their numbers
  int chosen = 0;               ///< number of the build whose model is shown; 0: the scan's own
  bool have_colours = false;    ///< models can get colours: laser-line pictures have them
  bool have_views = true;       ///< models can tell how many depth images saw a place: not by laser
};

/// What a person has written about a scan; each text is empty if there is none.
struct ScanLabel {
  std::string name = {};
  std::string notes = {};
  std::string tags = {};  ///< one a line
  std::string inventory_number = {};
  std::string author = {};   ///< of the model
  std::string licence = {};  ///< of the model
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
  std::optional<ScanCalibration> calibration = {};  ///< after the last stop, if solved
  std::optional<Model> model = {};                  ///< made by the scan itself
  JobBuilds builds = {};
  std::optional<PoseOf> pose_of = {};  ///< of a scan of another pose
};

/// Returns the build of that number; null if there is none.
const Build* find_build(const Job& job, int number);

/// Returns the chosen build's model, else the scan's own; null if there is none.
const Model* chosen_model(const Job& job);

/// Returns a scan as its worker has it, with what others may have changed in the stored scan
/// meanwhile: the label and the builds.
Job with_stored_changes(Job working, const Job& stored);

/// Marks a scan as interrupted, because the program ended or its outcome could not be saved: it can
/// be resumed.
/// @param snapshots  number of stored snapshots
Job to_interrupted(Job job, int snapshots, const Failure& reason = interruption());

// A scan's label has its own files, because a running scan writes `job.json`.

/// A change of a scan's label; nullopt: unchanged.
struct LabelChange {
  std::optional<std::string> name = {};
  std::optional<std::string> notes = {};
  std::optional<std::string> tags = {};
  std::optional<std::string> inventory_number = {};
  std::optional<std::string> author = {};
  std::optional<std::string> licence = {};
};

/// Whether text is a valid name: one line of at most 100 characters.
bool is_name(const std::string& text);

/// A text of a label: a row of the table from which the scan's folder, its archive and the
/// interface take what they have.
struct LabelText {
  std::string_view key;   ///< in the interface
  std::string_view file;  ///< in the scan's folder
  std::string_view rule;  ///< completes "... must be"
  bool (*is_valid)(const std::string& text);
  std::string ScanLabel::*text;
  std::optional<std::string> LabelChange::*change;
  bool is_list = false;      ///< whether each line is a text of its own
  bool is_in_model = false;  ///< whether a model's files contain it
};
std::span<const LabelText> label_texts();

/// Returns the label after the change.
ScanLabel changed(ScanLabel label, const LabelChange& change);

/// Reads the texts in a scan's folder. One that is missing, unreadable or too large is empty.
ScanLabel read_label(const std::filesystem::path& folder);

/// Writes the changed files, each atomically.
/// @throws Error "disk-full", "write-failed"
void write_label(const std::filesystem::path& folder, const LabelChange& change);

/// The time in a scan's id, in steps of 20 us.
using ScanTime = std::chrono::sys_time<std::chrono::duration<std::int64_t, std::ratio<1, 50000>>>;

/// Whether a text has the form of a scan's id, "20261121-081500-3f2a". No other text may become
/// part of a path.
bool is_scan_id(std::string_view text);

/// Formats date and time of day (UTC) and the fraction of the second, so that ids sort by time.
std::string to_scan_id(ScanTime time);

/// Returns the time of an id. @param id  of the form that `is_scan_id` checks
ScanTime to_time(const std::string& id);

}  // namespace octurn
