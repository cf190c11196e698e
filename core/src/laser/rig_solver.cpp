#include "laser/rig_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "laser/laser_rig.hpp"
#include "parallel/fork_join.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double platform_radius = 0.14;  // metres, within which lines on the platform are searched
constexpr double platform_search = 0.025;  // metres above and below the configured platform
constexpr double height_step = 0.0005;     // metres, of the histogram of heights
constexpr double object_margin = 0.003;    // metres around the object
constexpr double platform_reach = 0.003;   // metres from the most frequent height
constexpr std::size_t platform_wanted = 6000;
constexpr std::size_t surface_wanted = 4000;  // of each laser
constexpr double object_height = 0.004;       // metres above the platform
constexpr double cost_scale = 0.0001;         // metres
// Where the lines of two lasers cross, both measure one point of the surface. Away from a crossing,
// the surface's bend between their points counts: at this distance as much as a line's noise.
constexpr double crossing_reach = 0.0002;  // metres
// Residuals per independent residual: neighbours on a line share speckle and smoothing, and pairs
// near one crossing share its error.
constexpr double surface_correlation = 40;
constexpr double platform_correlation = 25;

// Cauchy scale of each iteration, metres: wide first, for a start far from the solution.
constexpr std::array scales = {0.001,  0.001,  0.0005, 0.0003, 0.0002,
                               0.0002, 0.0002, 0.0002, 0.0002, 0.0002};
constexpr double confirming_distance = 0.0004;  // metres, as lasers of a right rig may disagree

constexpr int min_slip_pairs = 50;

// Converged below this change of each unknown, radians and metres: a micrometre at the object.
constexpr double at_rest = 0.000002;

/// Weight of a pair of points from two lasers; falls off with their distance.
double weight_of_pair(const LinePoint& p, const LinePoint& q) {
  return cauchy_weight(static_cast<double>((p.point - q.point).norm()), crossing_reach);
}

double cauchy_cost(const std::vector<float>& residuals) {
  double sum = 0;
  for (const float residual : residuals) {
    const double part = static_cast<double>(residual) / cost_scale;
    sum += std::log1p(part * part);
  }
  return residuals.empty() ? 0 : sum / static_cast<double>(residuals.size());
}

/// Least squares of a slip's angle, by the pairs of a point before a stop and one from it on.
struct SlipSums {
  double matrix = 0;
  double right = 0;
  double squares = 0;
  int pairs = 0;
};

Vector3d turned_to_stop(const Vector3d& object, double angle) {
  return Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * object;
}

}  // namespace

/// Normal equations of one kind of residuals.
struct RigSolver::Sums {
  explicit Sums(Index unknowns)
      : matrix(Eigen::MatrixXd::Zero(unknowns, unknowns)), right(VectorXd::Zero(unknowns)) {}

  void add(const VectorXd& row, double residual, double its_weight) {
    matrix.noalias() += its_weight * row * row.transpose();
    right -= its_weight * residual * row;
    weight += its_weight;
    squares += its_weight * residual * residual;
    residuals.push_back(static_cast<float>(std::abs(residual)));
  }

  /// The factor that scales the sums by the residuals' inverse variance, so that priors can be
  /// added.
  /// @param correlation  number of residuals per independent residual
  double information(double correlation) const {
    constexpr double least = 1e-10;  // square metres: 10 micrometres, the best accuracy
    return weight > 0 ? 1 / (std::max(squares / weight, least) * correlation) : 0;
  }

  Eigen::MatrixXd matrix;
  VectorXd right;
  double weight = 0;
  double squares = 0;
  std::vector<float> residuals = {};
};

RigSolver::RigSolver(const LaserLines& lines, LaserRig configured, int threads,
                     const std::stop_token& stop)
    : lines_(lines), stop_(stop), told_(std::move(configured)) {
  set_slipped({});
  const auto stops = static_cast<int>(lines.scan().shots.size());
  fork_join(threads, [&](int thread) {
    for (int at = thread; at < stops; at += threads) {
      throw_if_stopped(stop_);
      lines.at(static_cast<std::size_t>(at));
    }
  });
  find_platform();
}

/// Reads all points near the platform, with the configured rig. Sets the pivots, about which
/// rotation and shift of a plane are nearly independent.
std::vector<RigSolver::Reading> RigSolver::read_all() {
  std::vector<Reading> readings;
  pivots_.clear();
  for (std::size_t laser = 0; laser < told_.lasers.size(); ++laser) {
    const Laser& of = told_.lasers[laser];
    Vector3d sum = Vector3d::Zero();
    double count = 0;
    for (std::size_t stop = 0; stop < lines_.scan().shots.size(); ++stop) {
      for (const LineProfile::Ray& ray : lines_.at(stop)[laser].rays) {
        const Vector3d point = meet(ray, of);
        const Vector3d at = told_.platform_from_sensor * point;
        const double radius = at.head<2>().norm();
        if (radius < platform_radius && at.z() > -platform_search) {
          sum += point;
          count += 1;
          readings.push_back(
              {.point = {.laser = laser, .ray = ray}, .height = at.z(), .radius = radius});
        }
      }
    }
    pivots_.push_back(count > 0 ? Vector3d(sum / count) : Vector3d(of.normal * of.distance));
  }
  return readings;
}

/// Finds the rays that end on the platform: near the most frequent height, and outside the object's
/// radius, as its foot is nearly as low.
void RigSolver::find_platform() {
  std::vector<Reading> readings = read_all();
  const double height = usual_height(readings);
  const double object = object_radius(readings, height + object_height);
  std::erase_if(readings,
                [&](const Reading& r) { return std::abs(r.height - height) > platform_reach; });
  const auto beside = [&](const Reading& r) { return r.radius > object + object_margin; };
  if (static_cast<std::size_t>(std::ranges::count_if(readings, beside)) >= platform_wanted / 3) {
    std::erase_if(readings, [&](const Reading& r) { return !beside(r); });
  }
  const std::size_t step = std::max<std::size_t>(1, readings.size() / platform_wanted);
  for (std::size_t i = 0; i < readings.size(); i += step) {
    platform_.push_back(readings[i].point);
  }
}

/// The most frequent height of readings within the search range, metres.
double RigSolver::usual_height(const std::vector<Reading>& readings) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(2 * platform_search / height_step) + 1);
  for (const Reading& reading : readings) {
    if (reading.height < platform_search) {
      ++counts[static_cast<std::size_t>((reading.height + platform_search) / height_step)];
    }
  }
  const auto most = std::ranges::max_element(counts) - counts.begin();
  return (static_cast<double>(most) + 0.5) * height_step - platform_search;
}

/// The radius around the axis that contains 99.5 % of the readings above a height, metres.
double RigSolver::object_radius(const std::vector<Reading>& readings, double height) {
  std::vector<double> radii;
  for (const Reading& reading : readings) {
    if (reading.height > height) {
      radii.push_back(reading.radius);
    }
  }
  if (radii.empty()) {
    return 0;
  }
  const auto nearly_last =
      radii.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(radii.size()) * 0.995);
  std::ranges::nth_element(radii, nearly_last);
  return *nearly_last;
}

void RigSolver::add_platform(const LaserRig& rig, double scale, Sums& sums) const {
  VectorXd row(sums.right.size());
  for (const PlatformPoint& point : platform_) {
    const SeenPoint seen(rig, pivots_, point.laser, point.ray);
    const double height = seen.in_platform().z();
    row.setZero();
    seen.add_row(Vector3d::UnitZ(), 1, row);
    sums.add(row, height, cauchy_weight(height, scale));
  }
}

double RigSolver::Pair::distance() const {
  return to.normal.cast<double>().dot((from.point - to.point).cast<double>());
}

/// Visits surface points of each laser with the nearest one of every other, if it has one near.
/// @return number of points looked at
std::size_t RigSolver::visit_pairs(const LaserRig& rig, std::span<const double> angles,
                                   const std::function<void(const Pair&)>& visit) const {
  std::vector<LinePoints> surfaces;
  for (std::size_t laser = 0; laser < rig.lasers.size(); ++laser) {
    surfaces.emplace_back(lines_, rig, laser, angles, object_height);
  }
  std::size_t visited = 0;
  for (std::size_t from = 0; from < surfaces.size(); ++from) {
    const std::vector<LinePoint>& points = surfaces[from].all();
    const std::size_t step = std::max<std::size_t>(1, points.size() / surface_wanted);
    for (std::size_t i = 0; i < points.size(); i += step) {
      ++visited;
      for (std::size_t to = 0; to < surfaces.size(); ++to) {
        const LinePoint& p = points[i];
        const LinePoint* q = to == from ? nullptr : surfaces[to].nearest(p.point, p.normal);
        if (q != nullptr) {
          visit({.from = p, .to = *q, .from_laser = from, .to_laser = to});
        }
      }
    }
  }
  return visited;
}

void RigSolver::add_surfaces(const LaserRig& rig, double scale, Sums& sums) const {
  VectorXd row(sums.right.size());
  visit_pairs(rig, angles_, [&](const Pair& pair) {
    const Vector3d normal = pair.to.normal.cast<double>();
    const double residual = pair.distance();
    row.setZero();
    const auto add = [&](const LinePoint& point, std::size_t laser, double factor) {
      const SeenPoint seen(rig, pivots_, laser, lines_.at(point.stop)[laser].rays[point.ray]);
      seen.add_row(turned_to_stop(normal, angles_[point.stop]), factor, row);
    };
    add(pair.from, pair.from_laser, 1);
    add(pair.to, pair.to_laser, -1);
    sums.add(row, residual, cauchy_weight(residual, scale) * weight_of_pair(pair.from, pair.to));
  });
}

double RigSolver::confirmed_share(const LaserRig& rig, double turn_ratio) const {
  std::vector<double> angles = angles_;
  std::ranges::transform(angles, angles.begin(), [&](double angle) { return turn_ratio * angle; });
  double confirmed = 0;
  const std::size_t points = visit_pairs(rig, angles, [&](const Pair& pair) {
    confirmed += std::abs(pair.distance()) < confirming_distance ? 1 : 0;
  });
  return confirmed / static_cast<double>(std::max<std::size_t>(points, 1));
}

void RigSolver::set_slipped(std::span<const double> slipped) {
  angles_.clear();
  for (const Shot& shot : lines_.scan().shots) {
    angles_.push_back(shot.angle + (slipped.empty() ? 0 : slipped[angles_.size()]));
  }
}

std::optional<Slip> RigSolver::find_slip(const LaserRig& rig,
                                         std::optional<std::size_t> only) const {
  std::vector<SlipSums> at(angles_.size() + 1);
  visit_pairs(rig, angles_, [&](const Pair& pair) {
    const Vector3d around = Vector3d::UnitZ().cross(pair.from.point.cast<double>());
    const bool is_from_later = pair.from.stop > pair.to.stop;
    const double by_angle = (is_from_later ? 1 : -1) * pair.to.normal.cast<double>().dot(around);
    const double distance = pair.distance();
    const double weight =
        cauchy_weight(distance, scales.front()) * weight_of_pair(pair.from, pair.to);
    const auto add = [&](SlipSums& sums, int sign) {
      sums.matrix += sign * weight * by_angle * by_angle;
      sums.right += sign * weight * by_angle * distance;
      sums.squares += sign * weight * distance * distance;
      sums.pairs += sign;
    };
    const auto [earlier, later] = std::minmax(pair.from.stop, pair.to.stop);
    add(at[earlier + 1], 1);
    add(at[later + 1], -1);
  });
  SlipSums sums;
  SlipSums best;
  Slip slip;
  for (std::size_t stop = 1; stop < angles_.size(); ++stop) {
    sums.matrix += at[stop].matrix;
    sums.right += at[stop].right;
    sums.squares += at[stop].squares;
    sums.pairs += at[stop].pairs;
    if (only.value_or(stop) == stop && sums.matrix > 0 &&
        sums.right * sums.right * best.matrix >= best.right * best.right * sums.matrix) {
      best = sums;
      slip = {.stop = stop, .angle = sums.right / sums.matrix};
    }
  }
  slip.explained = best.squares > 0 ? slip.angle * best.right / best.squares : 0;
  return best.pairs >= min_slip_pairs ? std::optional(slip) : std::nullopt;
}

/// The normal equations of a rig, scaled by the residuals' inverse variance.
struct RigSolver::Equations {
  Eigen::MatrixXd matrix;
  VectorXd right;
};

/// @param[out] solution  residuals and cost of the rig
RigSolver::Equations RigSolver::linearise(const LaserRig& rig, double scale,
                                          RigSolution& solution) const {
  throw_if_stopped(stop_);
  const auto unknowns = pose_unknowns + plane_unknowns * static_cast<Index>(rig.lasers.size());
  Sums of_platform(unknowns);
  Sums of_surfaces(unknowns);
  add_platform(rig, scale, of_platform);
  add_surfaces(rig, scale, of_surfaces);
  solution.cost = cauchy_cost(of_platform.residuals) + cauchy_cost(of_surfaces.residuals);
  solution.platform_heights = std::move(of_platform.residuals);
  solution.surface_distances = std::move(of_surfaces.residuals);
  const double platform = of_platform.information(platform_correlation);
  const double surfaces = of_surfaces.information(surface_correlation);
  return {.matrix = platform * of_platform.matrix + surfaces * of_surfaces.matrix,
          .right = platform * of_platform.right + surfaces * of_surfaces.right};
}

RigSolution RigSolver::as_told() const {
  RigSolution solution{.rig = told_};
  linearise(told_, scales.back(), solution);
  return solution;
}

RigSolution RigSolver::solve(const RigTrust& trust) const {
  const auto unknowns = pose_unknowns + plane_unknowns * static_cast<Index>(told_.lasers.size());
  VectorXd sigmas(unknowns);
  sigmas.head<2>().setConstant(trust.pose_turn);
  sigmas.segment<3>(2).setConstant(trust.pose_shift);
  for (Index first = pose_unknowns; first < unknowns; first += plane_unknowns) {
    sigmas.segment<3>(first) << trust.plane_turn, trust.plane_tilt, trust.plane_shift;
  }
  const VectorXd prior = sigmas.array().square().inverse();
  VectorXd moved_so_far = VectorXd::Zero(unknowns);
  RigSolution solution{.rig = told_};
  for (const double scale : scales) {
    const Equations equations = linearise(solution.rig, scale, solution);
    Eigen::MatrixXd matrix = equations.matrix;
    matrix.diagonal() += prior;
    const VectorXd change = matrix.ldlt().solve(equations.right - prior.cwiseProduct(moved_so_far));
    if (!change.allFinite()) {
      break;
    }
    solution.rig = moved(solution.rig, pivots_, change);
    moved_so_far += change;
    if (scale == scales.back() && change.cwiseAbs().maxCoeff() < at_rest) {
      break;
    }
  }
  Equations last = linearise(solution.rig, scales.back(), solution);
  last.matrix.diagonal() += prior;
  solution.covariance = last.matrix.inverse();
  return solution;
}

}  // namespace octurn
