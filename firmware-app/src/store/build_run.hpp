#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "failure.hpp"
#include "store/build_settings.hpp"
#include "store/job.hpp"

namespace octurn {

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
