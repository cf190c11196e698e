#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>

#include "scan/scan_store.hpp"
#include "scan/status_board.hpp"

namespace octurn {

/// Runs one scan at a time on a worker of its own, which alone touches sensor, turntable and the
/// scan's octree. Everything else here may be called from any thread.
///
///              start                  every snapshot taken, and the model built
///     (none) --------> running ------------------------------------------------> finished
///                      |  ^  |  disk full, nothing in the clip box, ... --------> failed
///      device fails,   |  |  |  cancel ----------------------------------------> cancelled
///      also when tried |  |  |                                                       ^
///      again: paused <-+  |  +-> interrupted, when this program ends                 |
///                 |       |            |                                             |
///                 +-------+------------+---- resume; or cancel ----------------------+
class Scanner {
 public:
  Scanner(RigOptions rig, const Limits& limits, const ScanStore& store);
  ~Scanner() = default;
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Starts a scan, unless one runs: nothing then.
  /// @throws Error "disk-full", "data-failed"
  std::optional<Job> start(const ScanSettings& settings);

  /// Goes on with a scan that was paused or interrupted, at the stop where that was, unless one
  /// runs: nothing then.
  /// @throws Error "no-such-scan", "not-paused", "data-failed"
  std::optional<Job> resume(std::string_view id);

  /// Asks the scan of that id to stop, or ends it if it is paused or interrupted.
  /// @return false if it has ended already
  bool cancel(std::string_view id);

  Status status() const { return board_.status(); }

  /// Waits until no scan runs, but no longer than `patience`.
  Status wait_until_done(std::chrono::milliseconds patience) const;

  /// What the sensor sees now, or, during a scan, what it saw last.
  /// @throws Error "sensor-..."  if it sees nothing
  std::shared_ptr<const View> view();

  /// Looks, unless a scan runs, whether a device that failed works again.
  /// @throws Error "sensor-...", "turntable-..."  if it does not
  void expect_ready();

  std::shared_ptr<const Preview> preview() const { return board_.preview().get(); }

  /// Leave to reconstruct outside of a scan, for as long as it lives. There is one, as memory is
  /// for one octree. A scan that starts asks for it back, and waits until it has it.
  class Leave {
   public:
    explicit Leave(Scanner& scanner, std::stop_token stop)
        : scanner_(scanner), stop_(std::move(stop)) {}
    ~Leave() { scanner_.take_leave_back(); }
    Leave(const Leave&) = delete;
    Leave& operator=(const Leave&) = delete;

    const std::stop_token& stop() const { return stop_; }

   private:
    Scanner& scanner_;
    std::stop_token stop_;
  };

  /// @return nothing while a scan runs, or somebody has leave already
  std::unique_ptr<Leave> leave_to_reconstruct();

  /// Has the worker use the rig, between scans, and waits until it has. A scan that starts asks for
  /// it back.
  /// @param use  returns soon after its token has a stop request; what it throws comes out here
  /// @return false if it was not used, since a scan runs or this ends
  bool lend_rig(const std::function<void(Rig& rig, const std::stop_token& stop)>& use);

  /// Asks the worker to end, and whoever has leave. The destructor does the same, and waits for the
  /// worker.
  void request_stop();

 private:
  struct Order {
    Job job = {};
    std::stop_source cancel = {};
  };
  struct Loan {
    const std::function<void(Rig& rig, const std::stop_token& stop)>& use;
    std::stop_source stop = {};
    bool taken = false;  // by the worker
    bool used = false;
    bool done = false;
    std::exception_ptr failure = {};
  };
  enum class Demand { none, view, loan, scan };

  void give_order(const Job& job);
  void work(const std::stop_token& stop);
  Demand wait_for_demand(const std::stop_token& stop);
  void look(Rig& rig, const std::stop_token& stop);
  void look_for_turntable(Rig& rig);
  void run_order(Rig& rig, const std::stop_token& stop);
  void run_until_it_ends(Job& job, Rig& rig, const std::stop_token& stop);
  void attempt(Job& job, Rig& rig, const std::stop_token& stop);
  void lend(Rig& rig, const std::stop_token& stop);
  void end_loan();
  void let_go(Rig& rig);
  void save_platform_angle(double angle_deg);
  void finish(Job job);
  void take_leave_back();

  RigOptions rig_options_;
  Limits limits_;
  const ScanStore& store_;
  StatusBoard board_;
  mutable std::mutex mutex_;  // guards order_, leave_, loan_ and view_wanted_until_, and the
                              // job.json of scans that do not run
  std::condition_variable_any wake_;
  std::optional<Order> order_;             // the one job slot: full while a scan waits or runs
  std::optional<std::stop_source> leave_;  // full while somebody has leave
  Loan* loan_ = nullptr;                   // of whoever waits in lend_rig
  std::chrono::steady_clock::time_point view_wanted_until_ = {};
  std::jthread worker_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
