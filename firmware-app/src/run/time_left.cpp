#include "run/time_left.hpp"

#include <algorithm>
#include <cstddef>

namespace octurn {
namespace {

constexpr std::size_t stops_of_pace = 5;
constexpr std::size_t min_stops_of_pace = 2;
constexpr double max_rise = 1.1;

}  // namespace

Seconds ExpectedEnd::left(Clock::time_point now) const {
  return std::max(Seconds(end - now), later);
}

TimeLeft::TimeLeft(const ScanEstimate& before, int stops, int snapshots, Clock::time_point now)
    : before_(before), stops_(stops), snapshots_(snapshots) {
  tell_turn(now);
}

/// Ignores the time of the first snapshot: the platform may stand there already, and the sensor may
/// have to be opened.
void TimeLeft::count(int snapshots, Clock::time_point now) {
  if (snapshots <= snapshots_) {
    return;
  }
  if (last_) {
    pace_.emplace_back(now - *last_);
    if (pace_.size() > stops_of_pace) {
      pace_.erase(pace_.begin());
    }
  }
  last_ = now;
  snapshots_ = snapshots;
  tell_turn(now);
}

void TimeLeft::tell_turn(Clock::time_point now) {
  const bool has_pace = pace_.size() >= min_stops_of_pace;
  if (!has_pace && !before_.is_measured) {
    return;
  }
  const Seconds stop = has_pace ? median(pace_) : before_.stop;
  const Seconds left = stop * (stops_ - snapshots_ + 1) + before_.build;
  tell(left, left - stop, now);
}

void TimeLeft::begin_model(Clock::time_point now) { tell(before_.build, Seconds(0), now); }

void TimeLeft::count_model(double share, Clock::time_point since, Clock::time_point now) {
  if (share > 0) {
    tell(Seconds(now - since) * (1 - share) / share, Seconds(0), now);
  }
}

void TimeLeft::lose_pace() {
  last_.reset();
  expected_.reset();
}

void TimeLeft::tell(Seconds left, Seconds later, Clock::time_point now) {
  if (expected_) {
    left = std::min(left, max_rise * expected_->left(now));
  }
  expected_ = {.end = now + std::chrono::duration_cast<Clock::duration>(left),
               .later = std::min(later, left)};
}

}  // namespace octurn
