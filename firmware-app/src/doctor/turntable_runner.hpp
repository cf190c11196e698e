#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "config.hpp"
#include "doctor/turn_checks.hpp"
#include "failure.hpp"
#include "run/scanner.hpp"

namespace octurn {

/// A test of the turntable that runs or has ended.
struct TurnTest {
  enum class State { running, done, failed, cancelled };
  State state = State::running;
  double done = 0;  ///< from 0 to 1
  std::vector<TurnFinding> findings = {};
  std::optional<Failure> failure = {};
};

/// State of the turntable's jogs and tests.
struct TurntableState {
  enum class Doing { nothing, jogging, testing };
  Doing doing = Doing::nothing;
  std::optional<Failure> failure = {};  ///< of the last jog
  std::optional<TurnTest> test = {};    ///< the last one
};

/// Jogs and tests the turntable of a Scanner between its scans, one job at a time. Its thread waits
/// for the scanner's worker. Thread-safe.
class TurntableRunner {
 public:
  TurntableRunner(Scanner& scanner, const ScanStore& store) : scanner_(scanner), store_(store) {}
  ~TurntableRunner() { stop(); }
  TurntableRunner(const TurntableRunner&) = delete;
  TurntableRunner& operator=(const TurntableRunner&) = delete;

  TurntableState state() const;

  /// Turns the platform by an angle, counter-clockwise seen from above.
  /// @return false if a jog, a test or a scan runs
  bool jog(double deg);

  /// Starts a test, which measures a turn. @param config  in force @return false as `jog`
  bool test(const Config& config);

  /// Asks the jog or test to stop.
  void stop();

 private:
  using Job = std::function<void(Rig& rig, const std::stop_token& stop)>;

  bool start(TurntableState::Doing doing, Job job);
  void carry_out(const Job& job, const std::stop_token& stop);
  void run_test(Rig& rig, const Config& config, const std::stop_token& stop);
  void end(const std::optional<Failure>& failure);

  Scanner& scanner_;
  const ScanStore& store_;
  mutable std::mutex mutex_;  // guards what follows
  TurntableState state_ = {};
  std::stop_source stop_ = {};
  std::jthread thread_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
