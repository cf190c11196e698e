#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "failure.hpp"
#include "scan/build_settings.hpp"
#include "scan/job.hpp"

namespace octurn {

/// What is to be built from a stored scan.
struct BuildOrder {
  BuildSettings settings = {};
  bool becomes_model = false;  ///< it is chosen as the scan's model as soon as it is there
};

/// A build's job on a cluster.
struct ClusterJob {
  std::string id = {};      ///< its number there; empty before it has one
  std::string detail = {};  ///< what it waits for, or what is wrong with the cluster; or empty
};

/// A build that waits or goes on, or what became of the last one.
struct BuildRun {
  enum class State { waiting, running, finished, failed, cancelled };

  std::string scan = {};  ///< its id
  int number = 1;         ///< that the build will have
  State state = State::waiting;
  Phase phase = Phase::starting;
  std::string created = {};  ///< UTC, as in ISO 8601
  int snapshots_done = 0;    ///< that were read so far
  int snapshots = 0;
  BuildSettings settings = {};
  std::optional<Failure> failure = {};         ///< why there is no model
  std::optional<ClusterJob> cluster_job = {};  ///< of one that is built elsewhere

  bool has_ended() const { return state != State::waiting && state != State::running; }
};

/// Why a build ended for a scan, which has precedence.
Failure displaced_by_scan();

/// "build 2 of scan 20261122-081500": what a log calls it.
std::string describe(const BuildRun& run);

/// "waiting", "running", "finished", "failed", "cancelled".
std::string_view to_string(BuildRun::State state);

}  // namespace octurn
