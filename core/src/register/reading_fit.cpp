#include "register/reading_fit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "octurn/median.hpp"
#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int max_iterations = 10;
constexpr double settled_fit = 1e-6;             // metres
constexpr double readings_wanted = 300;          // of a stop
constexpr int max_reading_spacing = 6;           // pixels
constexpr double min_facing_cosine = 0.5;        // between a normal and the direction to the sensor
constexpr double min_reading_agreement = 0.7;    // cosine between two normals of one surface
constexpr double max_distance = 0.004;           // metres
constexpr double reading_cauchy_scale = 0.0015;  // metres
constexpr double correlated_pixels = 200;        // about 14 x 14 pixels share the sensor's error
constexpr double reading_contact_weight = 20;    // of a foot's point, the mean of many readings

/// Readings of all stops of a turn.
struct Readings {
  std::vector<std::vector<SurfacePoint>> of_stops = {};
  double per_patch = 1;  ///< readings in a patch of pixels that share the sensor's error
};

Readings take_readings(const SeenTurn& turn) {
  double pixels = 0;
  for (const StopView& view : turn.stops) {
    pixels += view.pixels();
  }
  const double each = pixels / static_cast<double>(std::max<std::size_t>(turn.stops.size(), 1));
  const int step =
      std::clamp(static_cast<int>(std::sqrt(each / readings_wanted)), 1, max_reading_spacing);
  Readings readings{.of_stops = {}, .per_patch = std::max(1.0, correlated_pixels / (step * step))};
  for (const StopView& view : turn.stops) {
    readings.of_stops.push_back(view.readings(step));
  }
  return readings;
}

/// One comparison: a reading, and the surface that another turn saw there.
struct Match {
  SurfacePoint reading;  ///< frame of its turn
  SurfacePoint surface;  ///< frame of the other turn
};

/// Calls `visit(Match)` for each stop of `other` that sees a surface at the reading.
/// @param other_from_reading  frame of the reading's turn to frame of `other`
/// @return whether any stop does
template <typename Visit>
bool match(const SurfacePoint& reading, const SeenTurn& other, const Isometry3d& other_from_reading,
           Visit visit) {
  const Vector3d point = other_from_reading * reading.point;
  const Vector3d normal = other_from_reading.linear() * reading.normal;
  bool any = false;
  for (const StopView& view : other.stops) {
    const Vector3d to_eye = view.eye() - point;
    const double towards = normal.dot(to_eye);
    if (towards <= 0 || towards < min_facing_cosine * to_eye.norm()) {
      continue;
    }
    const auto surface = view.look_up(point);
    if (surface && surface->normal.dot(normal) > min_reading_agreement &&
        std::abs(surface->normal.dot(point - surface->point)) < max_distance) {
      visit(Match{.reading = reading, .surface = *surface});
      any = true;
    }
  }
  return any;
}

/// The normal equations of one stop's readings, and the magnitudes of its distances.
struct StopFit {
  RigidFit fit = {};
  std::vector<float> distances = {};
  std::size_t matched = 0;  // readings that were compared

  void add(const Vector3d& point, const Vector3d& normal, double distance) {
    fit.add(point, normal, distance, cauchy_weight(distance, reading_cauchy_scale));
    distances.push_back(static_cast<float>(std::abs(distance)));
  }
};

/// The turns of a fit and their readings. Rotations are about `middle`.
struct Comparison {
  std::span<const PlacedTurn> placed;
  const SeenTurn& turn;
  Readings of_turn;
  std::vector<Readings> of_placed;
  Vector3d middle;
};

/// Compares the turn's readings at one stop with the surfaces that the placed turns saw.
void add_own(StopFit& fit, const Comparison& compared, std::size_t stop, const Isometry3d& pose) {
  for (const PlacedTurn& placed : compared.placed) {
    const Isometry3d placed_from_turn = placed.object_from_turn.inverse() * pose;
    for (const SurfacePoint& reading : compared.of_turn.of_stops[stop]) {
      const bool any = match(reading, *placed.turn, placed_from_turn, [&](const Match& pair) {
        const Vector3d at = pose * pair.reading.point;
        const Vector3d normal = placed.object_from_turn.linear() * pair.surface.normal;
        fit.add(at, normal, normal.dot(at - placed.object_from_turn * pair.surface.point));
      });
      fit.matched += any ? 1 : 0;
    }
  }
}

/// Compares a placed turn's readings at one stop with the surface of the turn, which moves.
void add_placed(StopFit& fit, const Comparison& compared, std::size_t which, std::size_t stop,
                const Isometry3d& pose) {
  const PlacedTurn& placed = compared.placed[which];
  const Isometry3d turn_from_placed = pose.inverse() * placed.object_from_turn;
  for (const SurfacePoint& reading : compared.of_placed[which].of_stops[stop]) {
    const bool any = match(reading, compared.turn, turn_from_placed, [&](const Match& pair) {
      const Vector3d at = pose * pair.surface.point;
      const Vector3d normal = pose.linear() * pair.surface.normal;
      fit.add(at, normal, normal.dot(at - placed.object_from_turn * pair.reading.point));
    });
    fit.matched += any ? 1 : 0;
  }
}

/// Compares all stops. Sums are added in the order of the stops, so that the result does not depend
/// on the number of threads.
StopFit compare(const Comparison& compared, const Isometry3d& pose, int threads,
                const std::stop_token& stop) {
  struct Work {
    std::size_t placed = 0;  // index; past the last: the turn itself
    std::size_t stop = 0;
  };
  std::vector<Work> work;
  for (std::size_t i = 0; i < compared.turn.stops.size(); ++i) {
    work.push_back({compared.placed.size(), i});
  }
  for (std::size_t which = 0; which < compared.placed.size(); ++which) {
    for (std::size_t i = 0; i < compared.placed[which].turn->stops.size(); ++i) {
      work.push_back({which, i});
    }
  }
  std::vector<StopFit> fits(work.size());
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < work.size(); i = next++) {
      throw_if_stopped(stop);
      fits[i].fit.middle = compared.middle;
      if (work[i].placed == compared.placed.size()) {
        add_own(fits[i], compared, work[i].stop, pose);
      } else {
        add_placed(fits[i], compared, work[i].placed, work[i].stop, pose);
      }
    }
  });
  StopFit all;
  all.fit.middle = compared.middle;
  for (const StopFit& fit : fits) {
    all.fit += fit.fit;
    all.matched += fit.matched;
    all.distances.insert(all.distances.end(), fit.distances.begin(), fit.distances.end());
  }
  return all;
}

/// Adds the constraints that flat feet lie on their platforms.
void add_feet(RigidFit& fit, const Comparison& compared, const Isometry3d& pose) {
  for (const PlacedTurn& placed : compared.placed) {
    const Isometry3d placed_from_turn = placed.object_from_turn.inverse() * pose;
    add_moving_foot(fit, find_contact(compared.turn.points, placed_from_turn, 1), pose,
                    reading_contact_weight);
    add_moving_platform(fit, find_contact(placed.turn->points, placed_from_turn.inverse(), 1),
                        placed.object_from_turn, reading_contact_weight);
  }
}

/// The number of comparisons per independent one. A patch of pixels that share one error takes part
/// in the comparisons of its own readings, and in as many as the surface for other readings: hence
/// the factor 2.
double find_correlation(const StopFit& fit, double readings_per_patch) {
  const auto pairs = static_cast<double>(fit.distances.size());
  return 2 * readings_per_patch * pairs /
         static_cast<double>(std::max<std::size_t>(fit.matched, 1));
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return std::sqrt(std::max(solver.eigenvalues().maxCoeff(), 0.0));
}

}  // namespace

ReadingFit fit_readings(std::span<const PlacedTurn> placed, const SeenTurn& turn,
                        const Isometry3d& start, const Vector3d& middle, int threads,
                        const std::stop_token& stop) {
  Comparison compared{.placed = placed,
                      .turn = turn,
                      .of_turn = take_readings(turn),
                      .of_placed = {},
                      .middle = middle};
  for (const PlacedTurn& other : placed) {
    compared.of_placed.push_back(take_readings(*other.turn));
  }
  ReadingFit result{.object_from_turn = start};
  StopFit last;
  for (int i = 0; i < max_iterations; ++i) {
    last = compare(compared, result.object_from_turn, threads, stop);
    add_feet(last.fit, compared, result.object_from_turn);
    const Isometry3d motion = last.fit.motion();
    result.object_from_turn = motion * result.object_from_turn;
    if (motion_length(motion, middle) < settled_fit) {
      break;
    }
  }
  const RigidFit::Matrix6d covariance =
      last.fit.covariance(find_correlation(last, compared.of_turn.per_patch));
  result.direction_sigma = largest_sigma(covariance.topLeftCorner<3, 3>());
  result.position_sigma = largest_sigma(covariance.bottomRightCorner<3, 3>());
  result.residual = median(std::move(last.distances));
  return result;
}

namespace {

constexpr double max_gap = 0.012;          // metres between foot and platform before the fit
constexpr double min_facing = 0.99;        // cosine between the foot's normal and straight down
constexpr double min_area_cells = 100;     // of 2 mm: 4 cm2
constexpr double max_spread = 0.0003;      // metres, of the foot's heights
constexpr double max_below_foot = 0.0015;  // metres below the foot that noise explains
constexpr double max_below_share = 0.02;

/// Adds a point-to-plane equation for each point of a foot: its distance from the platform is 0.
/// @param side  1 if the foot moves, -1 if the platform moves
void add_rows(RigidFit& fit, const Contact& contact, const Eigen::Isometry3d& object_from_points,
              double side, double of_weight) {
  const Vector3d normal = object_from_points.linear() * contact.up;
  for (const Vector3d& point : contact.foot) {
    const double distance = contact.up.dot(point) - contact.height;
    fit.add(object_from_points * point, side * normal, distance, of_weight);
  }
}

}  // namespace

Contact find_contact(const std::vector<SurfacePoint>& points,
                     const Eigen::Isometry3d& platform_from_points, double share) {
  Contact contact{.foot = {},
                  .up = platform_from_points.linear().row(2).transpose(),
                  .height = -platform_from_points.translation().z()};
  const auto height_above = [&](const Vector3d& point) {
    return contact.up.dot(point) - contact.height;
  };
  double sum = 0;
  double squares = 0;
  for (const SurfacePoint& point : points) {
    const double above = height_above(point.point);
    if (std::abs(above) < max_gap && contact.up.dot(point.normal) < -min_facing) {
      contact.foot.push_back(point.point);
      sum += above;
      squares += above * above;
    }
  }
  const auto count = static_cast<double>(contact.foot.size());
  if (count < min_area_cells * share ||
      squares / count - sum / count * sum / count > max_spread * max_spread) {
    contact.foot.clear();
    return contact;
  }
  const auto below =
      static_cast<double>(std::ranges::count_if(points, [&](const SurfacePoint& point) {
        return height_above(point.point) < sum / count - max_below_foot;
      }));
  if (below > max_below_share * count) {
    contact.foot.clear();
  }
  return contact;
}

void add_moving_foot(RigidFit& fit, const Contact& contact,
                     const Eigen::Isometry3d& object_from_points, double of_weight) {
  add_rows(fit, contact, object_from_points, 1, of_weight);
}

void add_moving_platform(RigidFit& fit, const Contact& contact,
                         const Eigen::Isometry3d& object_from_points, double of_weight) {
  add_rows(fit, contact, object_from_points, -1, of_weight);
}

}  // namespace octurn
