#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string_view>
#include <variant>

#include "scan/build_run.hpp"
#include "scan/job.hpp"
#include "scan/model_pipe.hpp"
#include "scan/pose_choice.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// Read the sensor once, for the preview.
struct CameraCommand {};

/// Check the rig.
struct DeviceCheckCommand {
  /// Returns soon after its token has a stop request.
  std::packaged_task<void(Rig& rig, const std::stop_token& stop)> check = {};
};

/// Make something of a stored scan for a request: a model with other settings, or the colours of
/// one.
struct RebuildCommand {
  /// Gives the pipe what it makes, and closes it; asks it whether to stop.
  std::function<void(ModelPipe& pipe)> make = {};
  std::shared_ptr<ModelPipe> pipe = {};
};

/// Build a model from a stored scan, and keep it.
struct BuildCommand {
  BuildRun run = {};
  bool becomes_model = false;
  std::optional<PoseChoice> pose = {};  ///< a pose is registered again, for a model of all
};

/// Run a scan that has just been created.
struct ScanCommand {
  Job job = {};
};

/// Go on with a scan that was paused or interrupted.
struct ResumeCommand {
  Job job = {};
};

/// Measure the sensor's pose with a turn.
struct CalibrateCommand {
  ScanSettings settings = {};  ///< `snapshots` are the stops
};

/// Look at a wall for the map of the sensor's own error.
struct WallCommand {
  int frames = 0;
};

/// Look at a board for the lens of a camera with lasers.
struct LensCommand {};

/// The worker's commands, the least urgent first.
using Command =
    std::variant<CameraCommand, DeviceCheckCommand, RebuildCommand, BuildCommand, ScanCommand,
                 ResumeCommand, CalibrateCommand, WallCommand, LensCommand>;

/// Why a scan is stopped.
enum class ScanStop { end, pause };

/// The one command that waits, and the one that the worker carries out. A scan, or a measurement of
/// the rig, stops any other command that is carried out and replaces the one that waits; a build
/// replaces a less urgent one that waits. Thread-safe.
class CommandSlot {
 public:
  using Clock = std::chrono::steady_clock;

  struct Taken {
    Command command = {};
    std::stop_source stop = {};
  };

  /// Puts a scan or a measurement of the rig into the slot. @return false if one waits or runs
  /// already, or after `end`
  bool offer_scan(Command scan);

  /// The same for a build. @return false also if another one waits or is carried out
  bool offer_build(BuildCommand build);

  /// The same for a model. One at a time waits until the model before it is done.
  /// @param stop      ends it
  /// @param patience  how long to wait for the model before it
  /// @return false also if a build waits or runs, or the model before it takes too long
  bool offer_rebuild(RebuildCommand rebuild, std::stop_source stop, Clock::duration patience);

  /// Waits for a free place. @return false if a scan, a build or a model waits or is made
  bool offer_check(DeviceCheckCommand check);

  /// Has the sensor read until that time.
  void want_camera(Clock::time_point until);

  /// Asks the scan that waits or runs to stop.
  void stop_scan(ScanStop why);
  /// Why the last scan was stopped.
  ScanStop scan_stop() const;
  /// The same for a build. @return whether it still waited, and will never begin
  bool stop_build();

  /// Whether a scan waits or runs.
  bool has_scan() const;

  /// Whether a scan, a build or a model waits or is made.
  bool is_occupied() const;

  /// Asks the command that is carried out to stop, and accepts no more.
  void end();
  bool has_ended() const;

  // For the worker.

  /// Waits for a command, and takes it. @return nothing after `patience`, or after `end`
  std::optional<Taken> take(Clock::duration patience);

  /// The command that was taken is done.
  void finish();

  /// Waits until a command arrives or the current one is asked to stop, for at most `patience`.
  void wait_for_command(Clock::duration patience);

 private:
  bool rank_is_free(std::size_t rank) const;
  bool offer(Command command, std::size_t rank);
  void put(Command command, std::stop_source stop);

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any changed_;
  std::optional<Taken> waiting_;
  std::optional<std::size_t> rank_;  // of the command that is carried out
  std::stop_source stop_;            // of the same
  ScanStop scan_stop_ = ScanStop::end;
  Clock::time_point camera_wanted_until_ = {};
  bool rebuild_waits_ = false;  // for the model before it
  bool ended_ = false;
};

}  // namespace octurn
