#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

struct Scan;

/// The depth images of one turn of the platform, by a sensor whose pose is known.
struct RegistrationTurn {
  Intrinsics intrinsics = {};
  /// Optical frame to platform frame, metres; as `calibrate` solves it.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// The platform's angle at each stop: radians, counter-clockwise seen from above.
  std::vector<double> angles = {};
  Box clip = {};  ///< metres, platform frame: readings outside are not of the object
  /// Reads the depth image of a stop; called by several threads at once.
  std::function<DepthFrame(std::size_t stop)> read = {};
  /// The object's pose, if it is known: platform frame at angle 0 to the object's frame, metres.
  std::optional<Eigen::Isometry3d> object_from_platform = {};
  /// The same as a person estimated it, within a centimetre and some 15 degrees: the start of the
  /// refinement. It is accepted even if other poses fit as well.
  std::optional<Eigen::Isometry3d> prior_object_from_platform = {};
};

/// Renders the depth images that a depth camera in the laser camera's place would have taken, from
/// at most 24 of the stops. Each shows the surface between the lines of the stops within 45
/// degrees. Reads the pictures once, and keeps only the depth images, 6 MB.
/// @param scan  of one turn
/// @throws Error "scan-missing", "snapshot-malformed"
/// @throws Stopped
RegistrationTurn laser_turn(const std::filesystem::path& folder, const Scan& scan,
                            const std::stop_token& stop = {});

/// The object's pose in one turn, and its uncertainty.
struct RegisteredPose {
  /// Platform frame at angle 0 to the object's frame, which is the first turn's platform frame;
  /// metres.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  double position_sigma = 0;   ///< metres, of the object's middle
  double direction_sigma = 0;  ///< radians
  double overlap = 0;          ///< share of this turn's points on the surface of earlier turns
  double residual = 0;         ///< metres: median distance between the surfaces of both
  /// Share of this turn's points in free space of an earlier turn, plus share of earlier points in
  /// free space of this turn; 0 to 2.
  double contradiction = 0;
  bool symmetric = false;  ///< other poses give the same shape
};

/// A pose of a turn that fits, for a person to choose from.
struct RegistrationCandidate {
  /// Platform frame at angle 0 to the object's frame, metres.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  double overlap = 0;        ///< as of `RegisteredPose`
  double residual = 0;       ///< metres, root mean square along the normals
  double contradiction = 0;  ///< as of `RegisteredPose`
};

/// The poses of all turns.
struct Registration {
  bool accepted = false;
  std::string reason = {};  ///< why it was refused, for people; empty if accepted
  /// One for each turn, if accepted. The first, and those that were known, have no sigma.
  std::vector<RegisteredPose> poses = {};
  /// Of the last turn, if its pose was not known: about five that differ in shape, the best first.
  std::vector<RegistrationCandidate> candidates = {};
  /// At most 4,000 points of each turn: metres, its platform frame at angle 0.
  std::vector<std::vector<Eigen::Vector3f>> points = {};
};

/// One point of the object, in two turns.
struct PointPair {
  Eigen::Vector3d object = Eigen::Vector3d::Zero();    ///< metres, object's frame
  Eigen::Vector3d platform = Eigen::Vector3d::Zero();  ///< metres, the other turn's platform frame
};

/// The rigid transform from `platform` to `object` with the least squared distances (Kabsch 1976).
/// @return object_from_platform; nothing for fewer than three pairs, or if the points are nearly
///         collinear
std::optional<Eigen::Isometry3d> pose_from_pairs(std::span<const PointPair> pairs);

/// Finds the pose of one object on the platform in each of several turns, without an initial
/// estimate.
///
/// The points of a turn are compared with those of the turns before it in all rotations. The best
/// poses are refined (point-to-plane ICP) and ranked by free space: a pose is wrong if it puts the
/// surface of one turn into free space of another. Poses that give the same shape count as one. The
/// accepted pose is refined on the readings themselves (Gauss-Newton, six unknowns). docs/merge.md
/// has the method.
///
/// Deterministic for any number of threads. Takes about 10 MB for two turns of 24 stops of 640 x
/// 480.
/// @param turns  at least two
/// @throws std::invalid_argument  if a depth image has another size than the intrinsics say
/// @throws Stopped
Registration register_turns(std::span<const RegistrationTurn> turns, int threads = 1,
                            const std::stop_token& stop = {});

}  // namespace octurn
