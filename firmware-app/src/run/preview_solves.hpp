#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace octurn {

/// Says after which snapshots of a turn the sensor's pose is solved for the preview: once a third
/// of the turn is seen, since a quarter determines the axis. More views may determine what fewer
/// did not: a refused solution is tried again after a half and after two thirds, and then no more.
class PreviewSolves {
 public:
  /// @param snapshots  of the whole turn
  explicit PreviewSolves(int snapshots) : snapshots_(snapshots) {}

  /// Begins after the snapshots of an earlier attempt at the scan. While a device fails, attempts
  /// follow each other: none solves before it has taken a stop.
  void resume_after(int done) { after_ = done; }

  /// Whether the pose is to be solved after `done` snapshots.
  bool are_due(int done) const {
    return next_ < shares.size() && done > after_ && done < snapshots_ &&
           done >= std::max(shares[next_] * snapshots_, min_stops);
  }

  /// Records that the pose is solved after `done` snapshots.
  void take(int done) {
    do {
      ++next_;
    } while (next_ < shares.size() && shares[next_] * snapshots_ <= done);
  }

  /// Records that a solution was accepted: no other is needed.
  void end() { next_ = shares.size(); }

 private:
  static constexpr std::array shares{1.0 / 3, 1.0 / 2, 2.0 / 3};
  static constexpr double min_stops = 6;

  int snapshots_;
  int after_ = 0;
  std::size_t next_ = 0;  // index of the next share
};

}  // namespace octurn
