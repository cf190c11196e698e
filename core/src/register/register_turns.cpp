#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "octurn/register.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "register/nearest_points.hpp"
#include "register/pose_search.hpp"
#include "register/reading_fit.hpp"
#include "register/same_shape.hpp"
#include "register/seen_turn.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t min_points = 300;  // of a turn: 3 cm2 to 12 cm2 of surface
constexpr std::size_t searched_points = 300;
constexpr std::size_t refined_points = 1500;
constexpr int rough_iterations = 6;
constexpr std::size_t refined_poses = 60;
constexpr int iterations = 40;

// A pose is accepted below this contradiction, and if no other one that gives another shape comes
// near to it.
constexpr double max_contradiction = 0.25;
constexpr double min_lead = 0.10;
constexpr double similar_overlap = 0.85;  // of the best one's
constexpr double similar_residual = 1.5;
constexpr double min_overlap = 0.15;
constexpr double max_residual = 0.0015;  // metres

/// What all placed turns saw, in the object's frame.
struct Target {
  std::vector<PlacedTurn> turns;
  NearestPoints points;
};

Target make_target(std::vector<PlacedTurn> turns) {
  std::vector<SurfacePoint> points;
  for (const PlacedTurn& placed : turns) {
    for (const SurfacePoint& point : placed.turn->points) {
      points.push_back({.point = placed.object_from_turn * point.point,
                        .normal = placed.object_from_turn.linear() * point.normal});
    }
  }
  return {.turns = std::move(turns), .points = NearestPoints(std::move(points))};
}

/// How much a pose of a turn contradicts what the target's turns saw, and they what it saw.
double contradiction(const Target& target, const SeenTurn& turn,
                     const std::vector<SurfacePoint>& points,
                     const std::vector<SurfacePoint>& target_points, const Isometry3d& pose) {
  double worst = 0;
  for (const PlacedTurn& placed : target.turns) {
    worst = std::max(
        worst, contradicted_share(*placed.turn, points, placed.object_from_turn.inverse() * pose));
  }
  return worst + contradicted_share(turn, target_points, pose.inverse());
}

/// @param points  some of the turn's
Stands make_stands(const Target& target, const SeenTurn& turn,
                   const std::vector<SurfacePoint>& points, std::size_t point_count) {
  const auto share = [](const auto& some, const auto& all) {
    return static_cast<double>(some.size()) /
           static_cast<double>(std::max<std::size_t>(all.size(), 1));
  };
  Stands stands{.target_from_platforms = {},
                .target_points = thinned(target.points.points(), point_count)};
  stands.target_share = share(stands.target_points, target.points.points());
  stands.share = share(points, turn.points);
  for (const PlacedTurn& placed : target.turns) {
    stands.target_from_platforms.push_back(placed.object_from_turn);
  }
  return stands;
}

/// Refines and judges candidates with so many points. @return the distinct ones, the best first
std::vector<PoseCandidate> judged(std::vector<PoseCandidate> candidates, const Target& target,
                                  const SeenTurn& turn, std::size_t point_count, int steps,
                                  int threads, const std::stop_token& stop) {
  const std::vector<SurfacePoint> points = thinned(turn.points, point_count);
  const Stands stands = make_stands(target, turn, points, point_count);
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < candidates.size(); i = next++) {
      throw_if_stopped(stop);
      PoseCandidate& candidate = candidates[i];
      candidate = refine(target.points, stands, points, candidate, steps);
      candidate.contradiction =
          contradiction(target, turn, points, stands.target_points, candidate.target_from_points);
    }
  });
  std::ranges::stable_sort(candidates, {}, &PoseCandidate::contradiction);
  return distinct(candidates, NearestPoints(points).middle());
}

/// The poses that fit, the best first.
std::vector<PoseCandidate> find_candidates(const Target& target, const SeenTurn& turn, int threads,
                                           const std::stop_token& stop) {
  auto candidates =
      search_poses(target.points, thinned(turn.points, searched_points), threads, stop);
  candidates =
      judged(std::move(candidates), target, turn, searched_points, rough_iterations, threads, stop);
  candidates.resize(std::min(candidates.size(), refined_poses));
  return judged(std::move(candidates), target, turn, refined_points, iterations, threads, stop);
}

std::string text(const char* format, double value) {
  std::array<char, 96> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string percent(double share) { return text("%.0f %%", 100 * share); }

/// How a turn fits, or why not.
struct Answer {
  RegisteredPose pose = {};
  std::string reason = {};  // empty if it fits
};

std::string refuse(const PoseCandidate& best) {
  if (best.contradiction > max_contradiction) {
    return "in the best fit, " + percent(best.contradiction / 2) +
           " of what one turn saw is where the other saw that nothing is: the turns are of two "
           "objects, or share too little of one";
  }
  if (best.overlap < min_overlap || best.residual > max_residual) {
    return "the best fit shares " + percent(best.overlap) + " of the surface, to within " +
           text("%.2f mm", mm_from_metres(best.residual)) + ": that is too little";
  }
  return {};
}

/// Whether a candidate fits about as well as the best one, and did not slide beside it.
bool is_rival(const PoseCandidate& candidate, const PoseCandidate& best) {
  return candidate.contradiction <= best.contradiction + min_lead &&
         candidate.residual <= similar_residual * best.residual &&
         candidate.overlap >= similar_overlap * best.overlap;
}

/// What the candidates beside the best one, the first, say.
struct Rivals {
  bool symmetric = false;
  std::string reason = {};  // to refuse, or empty
};

Rivals compare_rivals(const Target& target, const NearestPoints& turn,
                      const std::vector<PoseCandidate>& candidates) {
  const PoseCandidate& best = candidates.front();
  Rivals rivals;
  for (auto other = candidates.begin() + 1; other != candidates.end(); ++other) {
    if (!is_rival(*other, best)) {
      continue;
    }
    if (!same_shape(target.points, turn, best.target_from_points, other->target_from_points)) {
      const Eigen::AngleAxisd between(best.target_from_points.linear().transpose() *
                                      other->target_from_points.linear());
      rivals.reason = "two poses that are " + text("%.0f", degrees_from_radians(between.angle())) +
                      " degrees apart fit alike, and give different shapes";
      break;
    }
    rivals.symmetric = true;
  }
  return rivals;
}

Answer answer(const Target& target, const SeenTurn& turn, int threads,
              const std::stop_token& stop) {
  if (turn.points.size() < min_points) {
    return {.pose = {}, .reason = "too little of an object is seen"};
  }
  const auto candidates = find_candidates(target, turn, threads, stop);
  if (candidates.empty()) {
    return {.pose = {}, .reason = "too little of an object is seen"};
  }
  const PoseCandidate& best = candidates.front();
  if (std::string reason = refuse(best); !reason.empty()) {
    return {.pose = {}, .reason = std::move(reason)};
  }
  const NearestPoints points(turn.points);
  const Rivals rivals = compare_rivals(target, points, candidates);
  if (!rivals.reason.empty()) {
    return {.pose = {}, .reason = rivals.reason};
  }
  const Vector3d middle = best.target_from_points * points.middle();
  const ReadingFit fit =
      fit_readings(target.turns, turn, best.target_from_points, middle, threads, stop);
  return {.pose = {.object_from_platform = fit.object_from_turn,
                   .position_sigma = fit.position_sigma,
                   .direction_sigma = fit.direction_sigma,
                   .overlap = best.overlap,
                   .residual = fit.residual,
                   .contradiction = best.contradiction,
                   .symmetric = rivals.symmetric},
          .reason = {}};
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

/// Places all turns that fit to those which are placed, until no more does.
/// @return of the first that does not fit, its number and why
std::optional<std::pair<std::size_t, std::string>> place_all(
    const std::vector<SeenTurn>& seen, std::vector<std::optional<RegisteredPose>>& poses,
    int threads, const std::stop_token& stop) {
  for (bool progress = true; progress;) {
    progress = false;
    std::optional<std::pair<std::size_t, std::string>> refused;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (poses[i]) {
        continue;
      }
      Answer found = answer(make_target(placed_turns(seen, poses)), seen[i], threads, stop);
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

}  // namespace

Registration register_turns(std::span<const RegistrationTurn> turns, int threads,
                            const std::stop_token& stop) {
  std::vector<SeenTurn> seen;
  std::vector<std::optional<RegisteredPose>> poses(turns.size());
  for (std::size_t i = 0; i < turns.size(); ++i) {
    seen.push_back(read_turn(turns[i], threads, stop));
    if (i == 0 || turns[i].object_from_platform) {
      poses[i].emplace();
      poses[i]->object_from_platform =
          turns[i].object_from_platform.value_or(Isometry3d::Identity());
    }
  }
  Registration registration;
  if (!seen.empty() && seen.front().points.size() < min_points) {
    registration.reason = "turn 0: too little of an object is seen";
    return registration;
  }
  if (const auto refused = place_all(seen, poses, threads, stop)) {
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
