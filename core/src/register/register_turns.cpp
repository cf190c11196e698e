#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "octurn/register.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "register/compare_rivals.hpp"
#include "register/find_candidates.hpp"
#include "register/reading_fit.hpp"
#include "register/seen_turn.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t min_points = 300;     // of a turn, 3 to 12 cm2 of surface
constexpr std::size_t shown_points = 4000;  // of a turn, for display

// Thresholds for accepting a pose.
constexpr double max_contradiction = 0.2;
constexpr double min_overlap = 0.15;
constexpr double max_residual = 0.0015;  // metres

// Number of horizontal axes about which half turns of a symmetric object are tried.
constexpr int turns_over = 8;
constexpr double max_upright =
    0.3;                            // cosine between both upward axes; below it the underside shows
constexpr double max_worse = 1.15;  // times the best residual: noise explains as much

std::string text(const char* format, double value) {
  std::array<char, 96> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string percent(double share) { return text("%.0f %%", 100 * share); }

/// The result of placing one turn: its pose, or the reason for a refusal.
struct Answer {
  RegisteredPose pose = {};
  std::string reason = {};  // empty if it fits
  std::vector<RegistrationCandidate> candidates = {};
};

std::string refuse(const PoseCandidate& best) {
  if (best.contradiction > max_contradiction) {
    return "in the best fit, " + percent(best.contradiction / 2) +
           " of what one turn saw lies where the other saw empty space: the turns are of two "
           "objects, or share too little of one";
  }
  if (best.overlap < min_overlap || best.residual > max_residual) {
    return "the best fit shares " + percent(best.overlap) + " of the surface, to within " +
           text("%.2f mm", mm_from_metres(best.residual)) + ": that is too little";
  }
  return {};
}

/// The candidates from which a person can choose: one for each shape.
std::vector<RegistrationCandidate> to_choice(const std::vector<PoseCandidate>& candidates,
                                             const Target& target, const NearestPoints& turn) {
  std::vector<RegistrationCandidate> choice;
  for (const PoseCandidate& candidate : without_same_shapes(candidates, target, turn)) {
    choice.push_back({.object_from_platform = candidate.target_from_points,
                      .overlap = candidate.overlap,
                      .residual = candidate.residual,
                      .contradiction = candidate.contradiction});
  }
  return choice;
}

/// Refines the accepted candidate on the readings.
RegisteredPose refined(const Target& target, const SeenTurn& turn, const PoseCandidate& best,
                       const Vector3d& turn_middle, int threads, const std::stop_token& stop) {
  const ReadingFit fit = fit_readings(target.turns, turn, best.target_from_points,
                                      best.target_from_points * turn_middle, threads, stop);
  return {.object_from_platform = fit.object_from_turn,
          .position_sigma = fit.position_sigma,
          .direction_sigma = fit.direction_sigma,
          .overlap = best.overlap,
          .residual = fit.residual,
          .contradiction = best.contradiction};
}

/// Returns a pose of a symmetric object that fits as well as `best` and has the object upside down,
/// or `best` if there is none. The object was turned over to scan its underside, so an upright pose
/// is wrong.
PoseCandidate turned_over(const Target& target, const SeenTurn& turn, const NearestPoints& points,
                          const PoseCandidate& best) {
  const Vector3d middle = best.target_from_points * points.middle();
  for (int i = 0; i < turns_over; ++i) {
    const double angle = std::numbers::pi * i / turns_over;
    const Eigen::AngleAxisd over(std::numbers::pi, Vector3d(std::cos(angle), std::sin(angle), 0));
    PoseCandidate other =
        refine_candidate(target, turn,
                         Eigen::Translation3d(middle) * over * Eigen::Translation3d(-middle) *
                             best.target_from_points);
    if (refuse(other).empty() && fits_alike(other, best) &&
        other.residual <= max_worse * best.residual) {
      return other;
    }
  }
  return best;
}

/// Whether the same side of the object is up as in the placed turn; false if several are placed.
bool is_upright(const Target& target, const PoseCandidate& candidate) {
  return target.turns.size() == 1 &&
         candidate.target_from_points.linear().col(2).dot(
             target.turns.front().object_from_turn.linear().col(2)) > max_upright;
}

/// Searches all rotations for the turn's pose.
Answer search(const Target& target, const SeenTurn& turn, int threads,
              const std::stop_token& stop) {
  const NearestPoints points(turn.points);
  const auto candidates = find_candidates(target, turn, points, threads, stop);
  if (candidates.empty()) {
    return {.pose = {}, .reason = "too little of an object is seen"};
  }
  Answer answer{.candidates = to_choice(candidates, target, points)};
  const PoseCandidate& best = candidates.front();
  answer.reason = refuse(best);
  Rivals rivals;
  if (answer.reason.empty()) {
    rivals = compare_rivals(target, turn, points, candidates, threads, stop);
    answer.reason = rivals.reason;
  }
  if (answer.reason.empty()) {
    const bool is_shown = !rivals.symmetric || !is_upright(target, best);
    answer.pose = refined(target, turn, is_shown ? best : turned_over(target, turn, points, best),
                          points.middle(), threads, stop);
    answer.pose.symmetric = rivals.symmetric;
  }
  return answer;
}

/// Refines the pose that a person estimated.
Answer refine_given(const Target& target, const SeenTurn& turn, const Isometry3d& given,
                    int threads, const std::stop_token& stop) {
  const PoseCandidate candidate = refine_candidate(target, turn, given);
  Answer answer{.reason = refuse(candidate)};
  if (answer.reason.empty()) {
    answer.pose = refined(target, turn, candidate, find_middle(turn.points), threads, stop);
  }
  return answer;
}

Answer place(const Target& target, const SeenTurn& turn, const std::optional<Isometry3d>& given,
             int threads, const std::stop_token& stop) {
  if (turn.points.size() < min_points) {
    return {.pose = {}, .reason = "too little of an object is seen"};
  }
  return given ? refine_given(target, turn, *given, threads, stop)
               : search(target, turn, threads, stop);
}

/// Turns that are placed already.
std::vector<PlacedTurn> placed_turns(const std::vector<SeenTurn>& seen,
                                     const std::vector<std::optional<RegisteredPose>>& poses) {
  std::vector<PlacedTurn> placed;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (poses[i]) {
      placed.push_back({.turn = &seen[i], .object_from_turn = poses[i]->object_from_platform});
    }
  }
  return placed;
}

/// Registers turns one by one to the turns placed so far, until no other turn fits.
/// @param[out] candidates  of the last turn
/// @return number of the first turn that does not fit, and the reason; nothing if all fit
std::optional<std::pair<std::size_t, std::string>> place_all(
    std::span<const RegistrationTurn> turns, const std::vector<SeenTurn>& seen,
    std::vector<std::optional<RegisteredPose>>& poses,
    std::vector<RegistrationCandidate>& candidates, int threads, const std::stop_token& stop) {
  for (bool progress = true; progress;) {
    progress = false;
    std::optional<std::pair<std::size_t, std::string>> refused;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (poses[i]) {
        continue;
      }
      Answer found = place(make_target(placed_turns(seen, poses)), seen[i],
                           turns[i].prior_object_from_platform, threads, stop);
      if (i + 1 == seen.size()) {
        candidates = std::move(found.candidates);
      }
      if (found.reason.empty()) {
        poses[i] = found.pose;
        progress = true;
      } else if (!refused) {
        refused.emplace(i, std::move(found.reason));
      }
    }
    if (!refused || !progress) {
      return refused;
    }
  }
  return std::nullopt;
}

std::vector<Eigen::Vector3f> shown(const SeenTurn& turn) {
  std::vector<Eigen::Vector3f> points;
  for (const SurfacePoint& point : thinned(turn.points, shown_points)) {
    points.emplace_back(point.point.cast<float>());
  }
  return points;
}

}  // namespace

Registration register_turns(std::span<const RegistrationTurn> turns, int threads,
                            const std::stop_token& stop) {
  std::vector<SeenTurn> seen;
  std::vector<std::optional<RegisteredPose>> poses(turns.size());
  Registration registration;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    seen.push_back(read_turn(turns[i], threads, stop));
    registration.points.push_back(shown(seen.back()));
    if (i == 0 || turns[i].object_from_platform) {
      poses[i].emplace();
      poses[i]->object_from_platform =
          turns[i].object_from_platform.value_or(Isometry3d::Identity());
    }
  }
  if (!seen.empty() && seen.front().points.size() < min_points) {
    registration.reason = "turn 0: too little of an object is seen";
    return registration;
  }
  if (const auto refused = place_all(turns, seen, poses, registration.candidates, threads, stop)) {
    registration.reason = "turn " + std::to_string(refused->first) + ": " + refused->second;
    return registration;
  }
  registration.accepted = true;
  for (const auto& pose : poses) {
    registration.poses.push_back(*pose);
  }
  return registration;
}

}  // namespace octurn
