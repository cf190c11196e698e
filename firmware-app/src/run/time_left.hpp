#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "store/scan_estimate.hpp"

namespace octurn {

/// When something is expected to end.
struct ExpectedEnd {
  using Clock = std::chrono::steady_clock;

  Clock::time_point end = {};
  Seconds later = {};  ///< time of the steps after the current one

  /// Returns the remaining time at `now`: at least `later`, even if the current step takes longer
  /// than expected.
  Seconds left(Clock::time_point now) const;
};

/// Estimates the remaining time of a scan: the remaining stops times the median time of the last
/// five, plus the model's time from earlier scans. Updates, at stops and while the model is made,
/// raise the estimate by at most a tenth, because people do not believe a number that jumps.
class TimeLeft {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param before     estimate from earlier scans
  /// @param stops      number of stops of the whole turn
  /// @param snapshots  number already taken, of a resumed scan
  TimeLeft(const ScanEstimate& before, int stops, int snapshots, Clock::time_point now);

  /// Reports the number of stored snapshots.
  void count(int snapshots, Clock::time_point now);

  /// Reports that the last snapshot is stored, and the model is begun.
  void begin_model(Clock::time_point now);

  /// Reports the fraction of the snapshots, 0 to 1, that were added again since `since`.
  void count_model(double share, Clock::time_point since, Clock::time_point now);

  /// Drops the estimate: a device failed, for an unknown time.
  void lose_pace();

  /// The estimate; nullopt if it is unknown.
  const std::optional<ExpectedEnd>& expected() const { return expected_; }

 private:
  void tell_turn(Clock::time_point now);
  void tell(Seconds left, Seconds later, Clock::time_point now);

  ScanEstimate before_;
  int stops_;
  int snapshots_;
  std::optional<Clock::time_point> last_ = {};  // of the last snapshot; nullopt: after a failure
  std::vector<Seconds> pace_ = {};              // times of the last stops
  std::optional<ExpectedEnd> expected_ = {};
};

}  // namespace octurn
