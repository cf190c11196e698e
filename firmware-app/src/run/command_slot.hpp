#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "capture/rig.hpp"
#include "failure.hpp"
#include "octurn/reconstruct.hpp"
#include "store/builds.hpp"
#include "store/job.hpp"
#include "store/pose_choice.hpp"

namespace octurn {

/// A bounded queue of a model's bytes, from the thread that makes the model to the one that sends
/// it. Either end may stop it; then neither waits for the other.
class ModelPipe {
 public:
  static constexpr std::size_t max_bytes = std::size_t{1} << 20U;

  std::stop_source stop() const { return stop_; }

  // For the producer.

  void set_length(std::uint64_t bytes);
  /// Waits for room. @throws Stopped  if stopped
  void write(std::span<const std::byte> bytes);
  /// Called after the last byte.
  void close();
  /// Ends the model with a failure.
  void fail(Failure reason);

  // For the consumer.

  /// Waits for the length. @throws Error "busy" if stopped before, or the reason of `fail`
  std::uint64_t length();
  /// Waits for bytes. @return empty at the end, or if stopped or failed
  std::vector<std::byte> read();

 private:
  std::stop_source stop_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable_any changed_;
  std::optional<std::uint64_t> length_;
  std::deque<std::vector<std::byte>> blocks_;
  std::size_t held_bytes_ = 0;
  bool closed_ = false;
  std::optional<Failure> failure_;
};

/// A model that is made while it is sent: the consumer of a pipe. Its destructor stops the
/// producer.
class ModelStream {
 public:
  /// Waits until the model's size is known.
  /// @throws Error  if a snapshot is damaged, the model is empty or does not fit into memory
  /// @throws Error "busy"  if a scan starts meanwhile
  explicit ModelStream(std::shared_ptr<ModelPipe> pipe);
  ~ModelStream();
  ModelStream(const ModelStream&) = delete;
  ModelStream& operator=(const ModelStream&) = delete;

  std::uint64_t bytes() const { return bytes_; }

  /// Stop is requested if the model will not be completed, as when a scan starts.
  std::stop_token stop() const { return pipe_->stop().get_token(); }

  /// Passes the bytes of the STL to `sink`; call it once. Ends early if `sink` returns false or the
  /// model is stopped.
  void send(const std::function<bool(std::span<const std::byte>)>& sink);

 private:
  std::shared_ptr<ModelPipe> pipe_;  // shared with the thread that makes the model
  std::uint64_t bytes_ = 0;
};

/// Urgency of a command, ascending.
enum class Rank {
  camera,
  check,
  rebuild,
  build,
  scan,  ///< a scan, or a measurement of the rig
};

/// Read the sensor once, for the preview.
struct CameraCommand {
  static constexpr Rank rank = Rank::camera;
};

/// Check the rig.
struct DeviceCheckCommand {
  static constexpr Rank rank = Rank::check;
  /// Must return soon after a stop is requested.
  std::packaged_task<void(Rig& rig, const std::stop_token& stop)> check = {};
};

/// Compute something from a stored scan for an HTTP request: a model with other settings, or the
/// colours of a model.
struct RebuildCommand {
  static constexpr Rank rank = Rank::rebuild;
  /// Writes its result into the pipe, and closes it. Polls the pipe's stop token.
  std::function<void(ModelPipe& pipe)> make = {};
  std::shared_ptr<ModelPipe> pipe = {};
};

/// Build a model from a stored scan, and keep it.
struct BuildCommand {
  static constexpr Rank rank = Rank::build;
  BuildRun run = {};
  bool becomes_model = false;
  std::optional<PoseChoice> pose = {};  ///< registers this pose again, and merges all poses
};

/// Run a scan that has just been created.
struct ScanCommand {
  static constexpr Rank rank = Rank::scan;
  Job job = {};
};

/// Continue a scan that was paused, interrupted or cancelled.
struct ResumeCommand {
  static constexpr Rank rank = Rank::scan;
  Job job = {};
};

/// Measure the sensor's pose by a turn.
struct CalibrateCommand {
  static constexpr Rank rank = Rank::scan;
  ScanSettings settings = {};  ///< `snapshots` is the number of stops
};

/// Record frames of a flat wall for the map of the sensor's depth error.
struct WallCommand {
  static constexpr Rank rank = Rank::scan;
  int frames = 0;
};

/// Take pictures of a board to calibrate the lens of a camera with lasers, or a depth sensor.
struct LensCommand {
  static constexpr Rank rank = Rank::scan;
  double square = 0;  ///< metres: side of the board's squares
};

/// The worker's commands.
using Command =
    std::variant<CameraCommand, DeviceCheckCommand, RebuildCommand, BuildCommand, ScanCommand,
                 ResumeCommand, CalibrateCommand, WallCommand, LensCommand>;

/// Why a scan is stopped.
enum class ScanStop { end, pause };

/// A command queue of length one, and the command that the worker executes. A scan, or a
/// measurement of the rig, stops any other running command and replaces the waiting one. A build
/// replaces a less urgent waiting one. Any command stops a camera command. Thread-safe.
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

  /// The same for a build. @return false also if another build waits or runs
  bool offer_build(BuildCommand build);

  /// The same for a rebuild. Waits until the previous rebuild is done; only one caller waits at a
  /// time.
  /// @param stop      stops the rebuild
  /// @param patience  maximum wait for the previous rebuild
  /// @return false also if a build waits or runs, or the previous rebuild takes too long
  bool offer_rebuild(RebuildCommand rebuild, std::stop_source stop, Clock::duration patience);

  /// Puts a device check into the slot; waits until no other one is there.
  /// @return false if a scan, a measurement, a build or a rebuild waits or runs, or after `end`
  bool offer_check(DeviceCheckCommand check);

  /// Makes `take` return camera commands until that time.
  void want_camera(Clock::time_point until);

  /// Asks the waiting or running scan or measurement to stop.
  void stop_scan(ScanStop why);
  /// Why the last scan was stopped.
  ScanStop scan_stop() const;
  /// Asks the build to stop. @return whether it was still waiting, and so will never begin
  bool stop_build();
  /// Asks a running lens calibration to end with the views that it has.
  /// @return false if none runs, or it has none
  bool solve_lens();

  /// Whether a scan or a measurement waits or runs.
  bool has_scan() const;
  /// Whether this scan waits or runs.
  bool has_scan(std::string_view id) const;
  /// Whether a measurement waits or runs.
  bool has_measurement() const;
  /// Whether a build of this scan waits or runs.
  /// @param number  of the build; nullopt: any
  bool has_build(std::string_view scan, std::optional<int> number = {}) const;

  /// Whether a scan, a measurement or a build waits or runs.
  bool is_busy() const;
  /// Whether a scan, a measurement, a build or a rebuild waits or runs.
  bool is_occupied() const;

  /// Asks the running command to stop, and accepts no more.
  void end();
  bool has_ended() const;

  // For the worker.

  /// Waits for a command, and takes it. @return nullopt after `patience`, or after `end`
  std::optional<Taken> take(Clock::duration patience);

  /// Reports that the running lens calibration has a view of the board.
  void report_lens_view();

  /// Reports that the taken command is done.
  void finish();

  /// Waits until a command arrives or the current one is asked to stop, for at most `patience`.
  void wait_for_command(Clock::duration patience);

 private:
  /// What a command works on.
  struct Subject {
    Rank rank = Rank::camera;
    std::optional<std::string> scan = {};  ///< id; nullopt: none, as of a measurement
    int build = 0;                         ///< number
    bool is_lens = false;
    bool has_views = false;  ///< of a lens calibration
  };

  static Subject to_subject(const Command& command);
  template <typename Matches>
  bool has(Matches matches) const;
  bool rank_is_free(Rank rank) const;
  bool offer(Command command);
  void put(Command command, std::stop_source stop);

  mutable std::mutex mutex_;  // guards the members below
  std::condition_variable_any changed_;
  std::optional<Taken> waiting_;
  std::optional<Subject> running_;
  std::stop_source stop_;  // of the running command
  ScanStop scan_stop_ = ScanStop::end;
  Clock::time_point camera_wanted_until_ = {};
  bool rebuild_waits_ = false;  // a caller waits for the previous rebuild
  bool ended_ = false;
};

/// Makes the model of a stored scan and writes it into a pipe, within the options' memory limit and
/// without using the disk.
/// @param options  of the model; `clip` is replaced by the scan's
/// @throws Error  if the scan cannot be read, the model is empty or does not fit into memory;
///                Stopped
void make_model(const std::filesystem::path& folder, ReconstructOptions options, ModelPipe& pipe);

/// Executes a command. Throws nothing: errors are passed through the pipe.
void rebuild(const RebuildCommand& command);

}  // namespace octurn
