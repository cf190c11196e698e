#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The depth images of one turn of the platform, and the configured pose of the rig.
struct CalibrationTurn {
  Intrinsics intrinsics = {};
  /// Optical frame to platform frame, metres.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// The platform's angle at each stop: radians, counter-clockwise seen from above.
  std::vector<double> angles = {};
  /// Whether the depth images were corrected by a `SensorMap`.
  bool has_sensor_map = false;
  /// Of the sensor, if they were measured before; they are taken out of the depth images. What the
  /// turn shows is combined with them by their sigmas.
  std::optional<SolvedOptics> optics = {};
  /// Reads the depth image of a stop. Called once for each, by several threads at once.
  std::function<DepthFrame(std::size_t stop)> read = {};
};

/// A fault of the rig or of the turn that a new pose does not cure.
struct CalibrationFinding {
  /// "slip", "turn-not-whole", "still", "turn-ratio", "turn-unknown", "alike", "wobble", "moved",
  /// "focal-length", "optics", "no-map"
  std::string code = {};
  std::string detail = {};           ///< what was found and its size, for people
  std::string hint = {};             ///< what to do about it
  std::optional<int> stop = {};      ///< where the platform slipped, counted from 0
  std::optional<double> angle = {};  ///< by which it slipped, radians
  Parameters parameters = {};        ///< the values in `detail`, for translations
};

/// The sensor's pose, as solved from the depth images of a turn.
struct CalibrationReport {
  bool accepted = false;
  std::string reason = {};  ///< why it was refused, for people; empty if accepted
  /// If accepted: optical frame to platform frame, metres. Depth images do not show the rotation
  /// about the platform's axis: it is that of the configured pose.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  double shift = 0;  ///< metres: from the configured axis to the solved one, on the platform
  double lift = 0;   ///< metres: from the configured surface to the solved one, along the axis
  double tilt = 0;   ///< radians: between the configured axis and the solved one
  double position_sigma = 0;   ///< metres, of the axis, 5 cm above the platform
  double direction_sigma = 0;  ///< radians, of the axis
  /// Metres: median distance between the surfaces that two stops saw, with the configured pose.
  double before = 0;
  double after = 0;  ///< the same with the solved pose
  /// Radians: each stop's measured angle less its configured one. 0 at the first stop; empty if too
  /// little of the object was seen.
  std::vector<double> stop_offsets = {};
  std::vector<CalibrationFinding> findings = {};
  /// Radians: how far the platform had slipped at each stop. The pose is solved with the angles
  /// that it thus had. Empty or 0 if it did not slip.
  std::vector<double> slipped = {};
  /// What is known of the optics after the turn; nothing if it tells nothing of them.
  std::optional<SolvedOptics> optics = {};
  /// Whether they replace those with which the turn was read: they are far from them, or known far
  /// better. If accepted, the pose holds only together with them.
  bool optics_differ = false;

  /// Whether the configured pose is within three sigma of the solved one, or within 0.1 mm and 0.05
  /// degrees, and the sensor's own optics and the configured angles hold.
  bool confirms_told() const;
};

/// Finds the platform's plane and turning axis in the sensor's frame from the depth images of one
/// turn of any object.
///
/// The platform's surface gives tilt and height. The axis is the one for which all stops see the
/// same object: a reading of one stop, rotated back by the stop's angle, must lie on the surface
/// that another stop saw (point-to-plane distances, minimised by Gauss-Newton over two rotations
/// and two translations). The platform's normal is a prior for the axis's direction.
/// docs/calibration.md has the derivation.
///
/// Deterministic for any number of threads. Takes about 12 MB for 36 stops of 640 x 480.
/// @throws std::invalid_argument  if a depth image has another size than the intrinsics say
CalibrationReport calibrate(const CalibrationTurn& turn, int threads = 1);

/// The pose of a camera with line lasers and the lasers' planes, as solved from a turn.
struct LaserCalibration {
  CalibrationReport report = {};
  std::vector<Laser> lasers = {};  ///< as solved, without `source`
  bool moved_a_plane = false;      ///< by more than 0.05 mm or 0.004 degrees
};

/// Finds the sensor's pose and the lasers' planes from the pictures of one turn by laser line.
///
/// Lines on the platform must lie in its plane, and points of the object measured with one laser on
/// the surface measured with the others. Without an object, or with one laser, only the first
/// constraint exists: then the pose stays as configured, and of each laser's plane the distance and
/// the rotation about the vertical are solved. docs/laser.md has the derivation.
///
/// Deterministic for any number of threads.
/// @throws Error  as `stored_snapshots`; "scan-malformed" if it is not one turn by laser line
/// @throws Stopped
LaserCalibration calibrate_lasers(const std::filesystem::path& folder, const Scan& scan,
                                  int threads, const std::stop_token& stop = {});

/// Returns the part of an accepted report that scan.json stores.
SolvedPose to_solved_pose(const CalibrationReport& report);

/// Result of solving a stored scan.
struct ScanSolution {
  CalibrationReport report = {};
  SolvedPose solved = {};      ///< the part that scan.json stores, if accepted
  bool replaces_told = false;  ///< accepted, and differs from the configured pose or planes
};

/// Solves the sensor's pose of a stored scan from its snapshots, starting at the configured pose;
/// of a laser-line scan, the lasers' planes as well.
///
/// @param snapshots  of the scan without a solved pose, whose optics would be in them; not read for
///                   a laser-line scan
/// @throws Error "scan-malformed"  if the scan is of several turns; errors of `snapshots`; Stopped
ScanSolution solve_scan(const std::filesystem::path& folder, const Scan& scan,
                        const SnapshotSource& snapshots, int threads, const std::stop_token& stop);

/// Gives a scan the solved pose, and the angles at which its platform stood, if they replace the
/// configured ones. @return whether they do
bool take_solution(Scan& scan, const ScanSolution& solution);

/// The plane of the platform's surface, in the platform frame of the configured pose.
struct PlatformSurface {
  double height = 0;  ///< metres: z where the configured axis meets it
  /// dz/dx and dz/dy; 0 if the configured pose is right.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double tilt = 0;  ///< radians, between its normal and the configured axis
};

/// Fits the platform's plane to one depth image, as `calibrate` does to those of a turn. An object
/// may stand on the platform.
/// @param platform_from_sensor  as configured: optical frame to platform frame, metres
/// @return nothing if no surface is seen within 60 mm and 6 degrees of the configured one
/// @throws std::invalid_argument  if the frame has another size than the intrinsics say
std::optional<PlatformSurface> measure_platform_surface(
    const DepthFrame& frame, const Intrinsics& intrinsics,
    const Eigen::Isometry3d& platform_from_sensor);

/// How an object moved on the platform between two depth images from the same platform angle.
struct ObjectMove {
  double shift = 0;        ///< metres along the platform, of the middle of its readings
  double shift_sigma = 0;  ///< metres, in the direction of the shift
  double turn = 0;         ///< radians about that middle, counter-clockwise seen from above
  double turn_sigma = 0;   ///< radians; large for an object that looks the same from all sides
};

/// Metres. The shift of an object that is not found again in the second depth image.
inline constexpr double max_measured_shift = 0.02;

/// Measures how an object moved between two depth images.
///
/// Both are taken at the same platform angle, so that the sensor's fixed errors cancel. A reading p
/// of the first, moved to R(turn) (p - m) + m + shift, must lie on the surface that the second
/// shows: point-to-plane distances (Chen and Medioni 1992), minimised by Gauss-Newton over the
/// shift along the platform and the turn about its normal. m is the mean of the readings.
///
/// @param first  its pose gives the platform's surface and axis
/// @param again  a second depth image from the same pose
/// @param clip   metres, object's frame: readings outside are not of the object
/// @return nothing if `first` shows too little of an object
/// @throws std::invalid_argument  if a frame's size is not that of the intrinsics
std::optional<ObjectMove> measure_move(const Snapshot& first, const DepthFrame& again,
                                       const Box& clip);

/// Adds the finding "moved" if the object moved by more than 1 mm or 0.6 degrees, and by three
/// sigma. Adds nothing if the findings of the turn already have a "moved", "slip" or
/// "turn-not-whole", any of which explains the move.
void add_move(std::vector<CalibrationFinding>& findings, const ObjectMove& move);

/// Writes a move as `last_look` into `folder/scan.json`, whole or not at all. All other keys stay.
/// @throws Error  as `read_scan` and `write_scan`
void write_object_move(const std::filesystem::path& folder, const ObjectMove& move);

/// Reads `last_look` of `folder/scan.json`.
/// @return nothing if there is no such key
/// @throws Error "scan-missing", "scan-malformed"
std::optional<ObjectMove> read_object_move(const std::filesystem::path& folder);

}  // namespace octurn
