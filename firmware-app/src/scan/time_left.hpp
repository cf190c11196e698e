#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "scan/scan_estimate.hpp"

namespace octurn {

/// When something is expected to end.
struct ExpectedEnd {
  using Clock = std::chrono::steady_clock;

  Clock::time_point end = {};
  std::chrono::duration<double> later = {};  ///< what comes after the step that goes on

  /// Time left at `now`: at least `later`, however long the step that goes on takes.
  std::chrono::duration<double> left(Clock::time_point now) const;
};

/// Estimates the time until a scan ends: stops left times the median of the last five, and the
/// model's time as earlier scans had it. Updated at stops only, and never by more than a tenth
/// upwards, as people do not believe a number that jumps.
class TimeLeft {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param before     what was expected of the scan
  /// @param stops      of the whole turn
  /// @param snapshots  that are there already, of a scan that goes on
  TimeLeft(const ScanEstimate& before, int stops, int snapshots, Clock::time_point now);

  /// So many snapshots are stored now.
  void count(int snapshots, Clock::time_point now);

  /// The last snapshot is stored, the model is begun.
  void begin_model(Clock::time_point now);

  /// A part of the model's snapshots is read again, 0 to 1, since its time.
  void count_model(double share, Clock::time_point since, Clock::time_point now);

  /// A device failed: how long that lasts, nobody knows.
  void lose_pace();

  /// Nothing where nobody knows.
  const std::optional<ExpectedEnd>& expected() const { return expected_; }

 private:
  void tell_turn(Clock::time_point now);
  void tell(std::chrono::duration<double> left, std::chrono::duration<double> later,
            Clock::time_point now);

  ScanEstimate before_;
  int stops_;
  int snapshots_;
  std::optional<Clock::time_point> last_ = {};  // when the last snapshot of a known pace was stored
  std::vector<std::chrono::duration<double>> pace_ = {};  // of the last stops
  std::optional<ExpectedEnd> expected_ = {};
};

}  // namespace octurn
