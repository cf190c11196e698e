#include "register/find_candidates.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <iterator>
#include <numbers>
#include <utility>

#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"
#include "register/same_shape.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;

constexpr std::size_t rough_points = 300;
constexpr std::size_t joined_points = 500;
constexpr int joined_iterations = 12;  // by then most have converged to a few poses
constexpr std::size_t refined_points = 1500;
constexpr int rough_iterations = 6;
constexpr std::size_t refined_poses = 60;
constexpr int refined_iterations = 40;
constexpr std::size_t max_shapes = 5;     // from which a person can choose
constexpr std::size_t shapes_turned = 2;  // best candidates whose half turns are tried, too

// A candidate whose contradiction exceeds the best one's by more is refined no further. The minimum
// leaves more candidates than a person can choose from.
constexpr double contradicted_far_more = 0.4;
constexpr std::size_t min_refined = 16;

// Candidates whose contradiction exceeds the smallest by less are sorted by their residual: false
// poses of a nearly symmetric object do not reach into free space, but fit worse.
constexpr double contradicted_alike = 0.10;
constexpr double contradicted_square =
    5e-7;  // metres^2 that a contradiction of 1 adds to the residual's square

/// The contradiction of a pose: the largest share of the turn's points in free space of a placed
/// turn, plus the share of the target's points in free space of the turn.
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

/// @param points  a subset of the turn's points
PlatformConstraints platform_constraints(const Target& target, const SeenTurn& turn,
                                         const std::vector<SurfacePoint>& points,
                                         std::size_t point_count) {
  const auto share = [](const auto& some, const auto& all) {
    return static_cast<double>(some.size()) /
           static_cast<double>(std::max<std::size_t>(all.size(), 1));
  };
  PlatformConstraints constraints{.target_from_platforms = {},
                                  .target_points = thinned(target.points.points(), point_count)};
  constraints.target_share = share(constraints.target_points, target.points.points());
  constraints.share = share(points, turn.points);
  for (const PlacedTurn& placed : target.turns) {
    constraints.target_from_platforms.push_back(placed.object_from_turn);
  }
  return constraints;
}

/// Refines candidates on `point_count` points, and measures their contradiction.
/// @return distinct candidates, the least contradicted first
std::vector<PoseCandidate> judged(std::vector<PoseCandidate> candidates, const Target& target,
                                  const SeenTurn& turn, std::size_t point_count, int steps,
                                  int threads, const std::stop_token& stop) {
  const std::vector<SurfacePoint> points = thinned(turn.points, point_count);
  const PlatformConstraints constraints = platform_constraints(target, turn, points, point_count);
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < candidates.size(); i = next++) {
      throw_if_stopped(stop);
      PoseCandidate& candidate = candidates[i];
      candidate = refine(target.points, constraints, points, candidate, steps);
      candidate.contradiction = contradiction(target, turn, points, constraints.target_points,
                                              candidate.target_from_points);
    }
  });
  std::ranges::stable_sort(candidates, {}, &PoseCandidate::contradiction);
  return distinct(candidates, find_middle(points));
}

/// Drops candidates with too large a contradiction. @param candidates  the least contradicted first
void drop_contradicted(std::vector<PoseCandidate>& candidates) {
  const auto end = std::ranges::find_if(candidates, [&](const PoseCandidate& candidate) {
    return candidate.contradiction > candidates.front().contradiction + contradicted_far_more;
  });
  const auto count = std::max(static_cast<std::size_t>(end - candidates.begin()), min_refined);
  candidates.resize(std::min(candidates.size(), count));
}

/// Sorts the candidates that are contradicted about as much as the first one by their residual.
/// @param candidates  the least contradicted first
void order_by_fit(std::vector<PoseCandidate>& candidates) {
  const auto alike_end = std::ranges::find_if(candidates, [&](const PoseCandidate& candidate) {
    return candidate.contradiction > candidates.front().contradiction + contradicted_alike;
  });
  std::ranges::stable_sort(candidates.begin(), alike_end, {}, [](const PoseCandidate& candidate) {
    return candidate.residual * candidate.residual + contradicted_square * candidate.contradiction;
  });
}

/// Rotates a candidate by half turns about the principal axes of the points of target and turn. A
/// nearly symmetric object fits in these poses as well, and a search with a subset of the points
/// may find only one of them.
std::vector<PoseCandidate> half_turns(const Target& target, const SeenTurn& turn,
                                      const PoseCandidate& candidate) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double count = 0;
  const auto add = [&](const Eigen::Vector3d& point) {
    sum += point;
    squares += point * point.transpose();
    ++count;
  };
  for (const SurfacePoint& point : target.points.points()) {
    add(point.point);
  }
  for (const SurfacePoint& point : turn.points) {
    add(candidate.target_from_points * point.point);
  }
  const Eigen::Vector3d middle = sum / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / count -
                                                            middle * middle.transpose());
  std::vector<PoseCandidate> turned;
  for (int i = 0; i < 3; ++i) {
    const Eigen::AngleAxisd half(std::numbers::pi, axes.eigenvectors().col(i));
    turned.emplace_back();
    turned.back().target_from_points = Eigen::Translation3d(middle) * half *
                                       Eigen::Translation3d(-middle) * candidate.target_from_points;
  }
  return turned;
}

/// Adds the half turns of the best candidates. @return distinct candidates, the best first
std::vector<PoseCandidate> with_half_turns(std::vector<PoseCandidate> candidates,
                                           const Target& target, const SeenTurn& turn, int threads,
                                           const std::stop_token& stop) {
  std::vector<PoseCandidate> turned;
  for (std::size_t i = 0; i < std::min(candidates.size(), shapes_turned); ++i) {
    std::ranges::copy(half_turns(target, turn, candidates[i]), std::back_inserter(turned));
  }
  turned =
      judged(std::move(turned), target, turn, refined_points, refined_iterations, threads, stop);
  candidates.insert(candidates.end(), turned.begin(), turned.end());
  std::ranges::stable_sort(candidates, {}, &PoseCandidate::contradiction);
  candidates = distinct(candidates, find_middle(turn.points));
  order_by_fit(candidates);
  return candidates;
}

/// Searches all rotations for poses in which target and turn may fit.
std::vector<PoseCandidate> searched(const Target& target, const SeenTurn& turn,
                                    const NearestPoints& points, int threads,
                                    const std::stop_token& stop) {
  const FreeSpace target_free(target.turns, threads, stop);
  const PlacedTurn own{.turn = &turn, .object_from_turn = Isometry3d::Identity()};
  const FreeSpace turn_free({&own, 1}, threads, stop);
  return search_poses({.nearest = target.points, .free = target_free},
                      {.nearest = points, .free = turn_free}, threads, stop);
}

}  // namespace

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

std::vector<PoseCandidate> find_candidates(const Target& target, const SeenTurn& turn,
                                           const NearestPoints& points, int threads,
                                           const std::stop_token& stop) {
  auto candidates = searched(target, turn, points, threads, stop);
  candidates =
      judged(std::move(candidates), target, turn, rough_points, rough_iterations, threads, stop);
  candidates.resize(std::min(candidates.size(), refined_poses));
  candidates =
      judged(std::move(candidates), target, turn, joined_points, joined_iterations, threads, stop);
  drop_contradicted(candidates);
  candidates = judged(std::move(candidates), target, turn, refined_points, refined_iterations,
                      threads, stop);
  order_by_fit(candidates);
  return with_half_turns(std::move(candidates), target, turn, threads, stop);
}

PoseCandidate refine_candidate(const Target& target, const SeenTurn& turn,
                               const Isometry3d& start) {
  PoseCandidate candidate;
  candidate.target_from_points = start;
  return judged({candidate}, target, turn, refined_points, refined_iterations, 1, {}).front();
}

std::vector<PoseCandidate> without_same_shapes(const std::vector<PoseCandidate>& candidates,
                                               const Target& target, const NearestPoints& turn) {
  std::vector<PoseCandidate> shapes;
  for (const PoseCandidate& candidate : candidates) {
    const bool is_new = std::ranges::none_of(shapes, [&](const PoseCandidate& shape) {
      return same_shape(target.points, turn, shape, candidate);
    });
    if (is_new) {
      shapes.push_back(candidate);
    }
    if (shapes.size() == max_shapes) {
      break;
    }
  }
  return shapes;
}

}  // namespace octurn
