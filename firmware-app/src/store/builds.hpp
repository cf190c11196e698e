#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "store/job.hpp"

namespace octurn {

/// The folder of a scan's builds. Each build has a subfolder, named after its number, with
/// `Scan.stl` and `build.json`.
inline constexpr const char* builds_folder = "builds";

/// The folder of a removed pose for the builds of its earlier scan that merge it. They return with
/// the pose from the bin.
inline constexpr const char* removed_builds_folder = "removed_builds";

/// Subfolder of a build that merges several poses: a scan folder with the snapshots of all of them.
inline constexpr const char* merged_folder = "scan";

/// The task file in the folder of a build that another process makes. The folder is not a build
/// until it also has a `build.json`.
inline constexpr const char* task_file = "task.json";

/// Writes `folder/build.json`. @throws Error "disk-full", "write-failed"
void write_build(const std::filesystem::path& folder, const Build& build);

/// Reads the builds of a scan, sorted by number. Unreadable ones are logged and left out.
std::vector<Build> read_builds(const std::filesystem::path& scan);

/// Reads the build in one folder. @throws Error "job-malformed", "read-failed"
Build read_build(const std::filesystem::path& folder, int number);

/// The number in the name of a build's folder; 0 if it is not such a folder.
int to_build_number(const std::string& name);

/// The smallest number above those of all builds' folders.
int next_build_number(const std::filesystem::path& scan);

/// A request to build a model from a stored scan.
struct BuildOrder {
  BuildSettings settings = {};
  bool becomes_model = false;  ///< once built, it is chosen as the scan's model
};

/// A build's job on a cluster.
struct ClusterJob {
  std::string id = {};      ///< number on the cluster; empty before the job is submitted
  std::string detail = {};  ///< why the job waits, or the cluster's error; may be empty
};

/// A build that waits, runs or has ended.
struct BuildRun {
  enum class State { waiting, running, finished, failed, cancelled };

  std::string scan = {};  ///< id of the scan
  int number = 1;         ///< of the build
  State state = State::waiting;
  Phase phase = Phase::starting;
  std::string created = {};  ///< UTC, as in ISO 8601
  int snapshots_done = 0;    ///< read so far
  int snapshots = 0;
  BuildSettings settings = {};
  std::optional<Failure> failure = {};         ///< why there is no model
  std::optional<ClusterJob> cluster_job = {};  ///< if a cluster builds it

  bool has_ended() const { return state != State::waiting && state != State::running; }
};

/// The failure of a build that was stopped because a scan started: scans have precedence.
Failure displaced_by_scan();

/// The build's name in logs: "build 2 of scan 20261122-081500".
std::string describe(const BuildRun& run);

/// "waiting", "running", "finished", "failed", "cancelled".
std::string_view to_string(BuildRun::State state);

}  // namespace octurn
