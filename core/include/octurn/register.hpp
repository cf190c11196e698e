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

/// The depth images of one turn of the platform, on a rig whose pose is known.
struct RegistrationTurn {
  Intrinsics intrinsics = {};
  /// Optical frame to platform frame, metres; as `calibrate` solves it.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// Of each stop: radians, counter-clockwise seen from above.
  std::vector<double> angles = {};
  Box clip = {};  ///< metres, platform frame: what lies outside is not the object's
  /// The depth image of a stop; called by several threads at once.
  std::function<DepthFrame(std::size_t stop)> read = {};
  /// How the object lay, if it is known: platform frame at angle 0 to the object's frame, metres.
  std::optional<Eigen::Isometry3d> object_from_platform = {};
  /// The same, as a person says, right to a centimetre and some 15 degrees: it is refined from
  /// there, and other poses that fit as well are no reason to refuse it.
  std::optional<Eigen::Isometry3d> told_object_from_platform = {};
};

/// A turn by laser line as a depth camera in the camera's place would have seen it from at most 24
/// of the stops: each depth image shows the surface between the lines of the stops within 45
/// degrees. The pictures are read here, and no more of them is kept than these images, 6 MB.
/// @param scan  of one turn
/// @throws Error "scan-missing", "snapshot-malformed"; Stopped
RegistrationTurn laser_turn(const std::filesystem::path& folder, const Scan& scan,
                            const std::stop_token& stop = {});

/// How the object lay in one turn, and how well that is known.
struct RegisteredPose {
  /// Platform frame at angle 0 to the object's frame, which is the first turn's platform frame.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  double position_sigma = 0;   ///< metres, of the object's middle; large where it can slide freely
  double direction_sigma = 0;  ///< radians
  double overlap = 0;          ///< share of this turn's points on the surface of earlier turns
  double residual = 0;         ///< metres: median distance between what both saw
  /// Share of this turn's points in space that an earlier turn saw to be empty, plus the share of
  /// earlier points in space that this turn saw to be empty; 0 to 2.
  double contradiction = 0;
  bool symmetric = false;  ///< other poses give the same shape
};

/// A pose of a turn that was found to fit, for a person to choose.
struct RegistrationCandidate {
  /// Platform frame at angle 0 to the object's frame, metres.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  double overlap = 0;        ///< as of `RegisteredPose`
  double residual = 0;       ///< metres, root mean square along the normals
  double contradiction = 0;  ///< as of `RegisteredPose`
};

/// How all turns fit together.
struct Registration {
  bool accepted = false;
  std::string reason = {};  ///< why not, for people; empty if accepted
  /// Of each turn, if accepted. The first, and those that were known, have no sigma.
  std::vector<RegisteredPose> poses = {};
  /// Of the last turn, if it was looked for: some five, each of another shape, the best first.
  std::vector<RegistrationCandidate> candidates = {};
  /// Some of what each turn saw, at most 4,000 points: metres, its platform's frame at angle 0.
  std::vector<std::vector<Eigen::Vector3f>> points = {};
};

/// A place of the object as two turns saw it.
struct PointPair {
  Eigen::Vector3d object = Eigen::Vector3d::Zero();    ///< metres, object's frame
  Eigen::Vector3d platform = Eigen::Vector3d::Zero();  ///< metres, the other turn's platform frame
};

/// The rotation and translation that take the second points of pairs to the first with the
/// smallest squared distances (Kabsch 1976).
/// @return object's frame from the platform's; nothing if there are fewer than three, or they lie
/// nearly on a line
std::optional<Eigen::Isometry3d> pose_from_pairs(std::span<const PointPair> pairs);

/// Finds how one object lay on the platform in each of several turns. Nothing is assumed of how it
/// was laid down.
///
/// The points of a turn are compared with those of the turns before it in all rotations; the best
/// ones are refined (point-to-plane ICP) and judged by free space: a pose is wrong if it puts what
/// one turn saw where another saw that nothing is. Several answers are taken as one if they give
/// the same shape. The accepted one is refined on the readings themselves (Gauss-Newton, six
/// unknowns). docs/merge.md has the method.
///
/// The same for any number of threads. About 10 MB for two turns of 24 stops of 640 x 480.
/// @param turns  at least two
/// @throws std::invalid_argument  if a depth image has another size than the intrinsics say
/// @throws Stopped
Registration register_turns(std::span<const RegistrationTurn> turns, int threads = 1,
                            const std::stop_token& stop = {});

}  // namespace octurn
