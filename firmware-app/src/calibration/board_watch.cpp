#include "calibration/board_watch.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/median.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr int most_views = 40;
constexpr int still_comparisons = 2;    // consecutive pictures that match their predecessor
constexpr double still_share = 0.0025;  // of the width: 2 pixels of 820 between pictures
constexpr double new_place = 0.15;      // of the width
constexpr double new_size = 1.25;       // ratio to another hold's size
constexpr double new_tilt_deg = 12;
constexpr double wanted_tilt_deg = 40;  // between two holds: twice the minimum of `calibrate_lens`
constexpr int views_before_tilt = 4;    // views before a missing tilt is reported
constexpr int missing_cells = 2;        // tolerated cells without a corner, of 36

/// Median distance from a view's corners to the nearest corner of another view, pixels.
double median_move(const BoardView& view, const BoardView& other) {
  std::vector<double> moves;
  for (const BoardCorner& corner : view) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const BoardCorner& before : other) {
      nearest = std::min(nearest, (before.pixel - corner.pixel).squaredNorm());
    }
    moves.push_back(nearest);
  }
  return std::sqrt(median(std::move(moves)));
}

}  // namespace

BoardWatch::BoardWatch(const Intrinsics& lens, FindBoard find, int wanted)
    : lens_(lens), find_(find) {
  look_.wanted = wanted;
}

bool BoardWatch::is_same(const BoardView& view, const BoardView& other) const {
  return !view.empty() && !other.empty() && median_move(view, other) < still_share * lens_.width;
}

bool BoardWatch::shows_last_view(const Picture& picture) const {
  return is_same(find_(picture), views_.back());
}

void BoardWatch::drop_last_view() {
  views_.pop_back();
  holds_.pop_back();
  look_.coverage = {};
  for (const BoardView& view : views_) {
    add_view(look_.coverage, view, lens_.width, lens_.height);
  }
  look_.taken = static_cast<int>(views_.size());
  look_.advice = BoardAdvice::hold_still;
}

bool BoardWatch::is_new(const Hold& hold) const {
  return std::ranges::none_of(holds_, [&](const Hold& other) {
    const double tilt = std::acos(std::clamp(hold.normal.dot(other.normal), -1.0, 1.0));
    return (hold.middle - other.middle).norm() < new_place * lens_.width &&
           std::max(hold.size, other.size) < new_size * std::min(hold.size, other.size) &&
           tilt < radians_from_degrees(new_tilt_deg);
  });
}

bool BoardWatch::adds_cells(const BoardView& view) const {
  LensCoverage coverage = look_.coverage;
  add_view(coverage, view, lens_.width, lens_.height);
  return coverage != look_.coverage;
}

bool BoardWatch::is_tilted() const {
  const double least = std::cos(radians_from_degrees(wanted_tilt_deg));
  return std::ranges::any_of(holds_, [&](const Hold& one) {
    return std::ranges::any_of(
        holds_, [&](const Hold& other) { return one.normal.dot(other.normal) < least; });
  });
}

bool BoardWatch::is_covered() const {
  return std::ranges::count(look_.coverage, false) <= missing_cells;
}

bool BoardWatch::is_complete() const {
  return look_.taken >= most_views || (look_.taken >= look_.wanted && is_tilted() && is_covered());
}

BoardAdvice BoardWatch::what_is_missing() const {
  if (look_.taken >= views_before_tilt && !is_tilted()) {
    return BoardAdvice::tilt;
  }
  return is_covered() ? BoardAdvice::turn : BoardAdvice::reach;
}

bool BoardWatch::see(const Picture& picture) {
  BoardView view = find_(picture);
  look_.corners.clear();
  for (const BoardCorner& corner : view) {
    look_.corners.emplace_back((corner.pixel.x() + 0.5) / lens_.width,
                               (corner.pixel.y() + 0.5) / lens_.height);
  }
  still_pictures_ = is_same(view, last_) ? still_pictures_ + 1 : 0;
  last_ = view;
  if (view.empty() || still_pictures_ < still_comparisons) {
    look_.advice = view.empty() ? BoardAdvice::show : BoardAdvice::hold_still;
    return false;
  }
  const BoardPlace place = place_board(view, lens_);
  const Hold hold{.middle = place.middle, .normal = place.normal, .size = place.square};
  const bool is_taken = is_new(hold) || adds_cells(view);
  if (is_taken) {
    add_view(look_.coverage, view, lens_.width, lens_.height);
    views_.push_back(std::move(view));
    holds_.push_back(hold);
    look_.taken = static_cast<int>(views_.size());
  }
  look_.advice = what_is_missing();
  return is_taken;
}

json to_json(const BoardLook& look) {
  constexpr std::array<std::string_view, 5> names{"show", "hold-still", "tilt", "reach", "turn"};
  json corners = json::array();
  for (const Vector2d& corner : look.corners) {
    const auto rounded = [](double share) { return std::round(share * 10000) / 10000; };
    corners.push_back({rounded(corner.x()), rounded(corner.y())});
  }
  json coverage = json::array();
  for (const bool is_seen : look.coverage) {
    coverage.push_back(is_seen ? 1 : 0);
  }
  return {{"advice", names[static_cast<std::size_t>(look.advice)]},
          {"corners", std::move(corners)},
          {"coverage", std::move(coverage)}};
}

}  // namespace octurn
