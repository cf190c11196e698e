#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/depth_png.hpp"
#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The depth images of one turn of the platform, and the rig as it was told.
struct CalibrationTurn {
  Intrinsics intrinsics = {};
  /// Optical frame to platform frame, metres.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  /// Of each stop: radians, counter-clockwise seen from above.
  std::vector<double> angles = {};
  /// Whether the depth images were corrected by a map of the sensor's own errors.
  bool has_sensor_map = false;
  /// The depth image of a stop, read once; called by several threads at once.
  std::function<DepthFrame(std::size_t stop)> read = {};
};

/// What a new pose does not cure: slip, turn-not-whole, still, wobble, moved, focal-length, no-map.
struct CalibrationFinding {
  std::string code = {};  ///< which of these
  std::string detail = {};
  std::string hint = {};
  std::optional<int> stop = {};      ///< of a slip, counted from 0
  std::optional<double> angle = {};  ///< of a slip, radians
  Parameters parameters = {};        ///< the values in `detail`; their names tell what it says
};

/// Where the sensor stands, as the depth images of a turn tell.
struct CalibrationReport {
  bool accepted = false;
  std::string reason = {};  ///< why not, for people; empty if accepted
  /// As solved, if accepted: optical frame to platform frame, metres. The turn about the platform's
  /// axis, which depth images cannot tell, is as told.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  double shift = 0;            ///< metres: how far the axis moves, at the platform's surface
  double lift = 0;             ///< metres: how far that surface moves along the axis
  double tilt = 0;             ///< radians, between the axis as told and as solved
  double position_sigma = 0;   ///< metres, of the axis, 5 cm above the platform
  double direction_sigma = 0;  ///< radians, of the axis
  double before = 0;  ///< metres: median distance between what two stops saw of the object, as told
  double after = 0;   ///< the same, as solved
  std::vector<double> stop_offsets = {};  ///< radians: the angle of each stop as seen less as told;
                                          ///< 0 at the first stop; empty if too little was seen
  std::vector<CalibrationFinding> findings = {};

  /// Whether the told pose is right as far as can be seen: within three sigma of the solved one, or
  /// within 0.1 mm and 0.05 degrees.
  bool confirms_told() const;
};

/// Finds the platform's plane and turning axis in the sensor's frame from the depth images of one
/// turn of any object.
///
/// The platform's surface gives tilt and height. The axis is where the stops agree about the
/// object: a reading of one stop, turned back, must lie on the surface that another stop saw
/// (point-to-plane distances, minimised by Gauss-Newton over two rotations and two translations).
/// The plane is a prior of the axis's direction. docs/calibration.md has the derivation.
///
/// The same on every machine and for any number of threads. About 12 MB for 36 stops of 640 x 480.
/// @throws std::invalid_argument  if a depth image has another size than the intrinsics say
CalibrationReport calibrate(const CalibrationTurn& turn, int threads = 1);

/// What the lines of a turn tell of a camera and its lasers.
struct LaserCalibration {
  CalibrationReport report = {};
  std::vector<Laser> lasers = {};  ///< as solved, without their sources
  bool moved_a_plane = false;      ///< far enough that models should be made with it
};

/// Finds the sensor's pose and the lasers' planes from the pictures of one turn by laser line.
///
/// The lines on the platform must lie in its plane; and what one laser shows of the object must lie
/// on what the others show. A turn without an object tells only the former, and so does a rig of
/// one laser: then the pose stays as told, and each plane's height is solved with its turn about
/// the vertical. docs/laser.md has the derivation.
///
/// The same for any number of threads.
/// @throws Error  as `stored_snapshots`; "scan-malformed" if it is no turn by laser line
/// @throws Stopped
LaserCalibration calibrate_lasers(const std::filesystem::path& folder, const Scan& scan,
                                  int threads, const std::stop_token& stop = {});

/// Where four squares of a printed board meet in a picture, two black and two white ones.
struct BoardCorner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< (0, 0) is the middle of the top left one
  int column = 0;  ///< on the board, in squares from any of its corners
  int row = 0;     ///< the same; from a row to the next as Y is from X in the optical frame
};

/// What a picture shows of a board, at least a part of it.
using BoardView = std::vector<BoardCorner>;

/// Finds a board of black and white squares, or the part of it that is in the picture. Where on the
/// board that part lies cannot be told from it, and a lens needs not know.
///
/// Candidates are ChESS features (Bennett and Lasenby 2014). Two are neighbours if the picture
/// between them is an edge, dark on one side and light on the other; neighbours make a lattice. A
/// corner is where all gradients around it are perpendicular to the way from it (Foerstner and
/// Guelch 1987).
///
/// @return in the order of rows, then columns; empty if fewer than 20 corners hang together
BoardView find_board(const Picture& picture);

/// How a board is held before a camera.
struct BoardPlace {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();   ///< pixels, of the corners that are seen
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of length one, away from the camera
  double square = 0;  ///< pixels, a mean square's side as it is seen
};

/// The same as a lens without distortion has it.
/// @param view  not empty
BoardPlace place_board(const BoardView& view, const Intrinsics& lens);

/// A camera's lens. Distortion is that of `LaserCamera`.
struct CameraLens {
  Intrinsics intrinsics = {};  ///< without a depth unit
  double k1 = 0;
  double k2 = 0;
};

/// How many cells of a picture to a side are asked for a corner of a board: 36 cells.
inline constexpr int lens_cells = 6;

/// Which cells of a picture a board's corners lie in, row by row.
using LensCoverage = std::array<bool, std::size_t{lens_cells} * lens_cells>;

/// Adds the cells of one view.
void add_view(LensCoverage& coverage, const BoardView& view, int width, int height);

/// A camera's lens, as views of a board tell.
struct LensReport {
  bool accepted = false;
  std::string reason = {};  ///< why not, for people; empty if accepted
  CameraLens lens = {};     ///< if there were enough views
  CameraLens sigma = {};    ///< of its numbers
  int views = 0;            ///< that were used
  int corners = 0;          ///< of all of them; those far off are left out
  double rms = 0;   ///< pixels, of the distances between corners and where the lens has them
  double tilt = 0;  ///< radians, the largest angle between two of the boards
  LensCoverage coverage = {};
};

/// Finds focal lengths, principal point and distortion of a lens from views of one flat board
/// (Zhang 2000): a homography of each view, fx and fy in closed form, then all numbers and the
/// board's poses by Levenberg and Marquardt's method. The side of its squares does not matter.
///
/// It is refused if fewer than 5 views show a board, if the boards are less than 20 degrees from
/// parallel or tell a focal length no better than to 0.3 %, if they reached less than 85 % of the
/// picture, if corners lie farther off than 0.6 pixels of 820 across, or if the distortion folds
/// the picture over. Deterministic.
///
/// @param width, height  pixels, of the pictures
LensReport calibrate_lens(std::span<const BoardView> views, int width, int height);

/// Where the platform's surface lies, in the platform frame as told.
struct PlatformSurface {
  double height = 0;  ///< metres, where the told axis meets it
  /// How it rises along x and y: 0 if it is as told, else the tangents of its angles.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double tilt = 0;  ///< radians, between its normal and the told axis
};

/// Fits the platform's plane to one look, as `calibrate` does to those of a turn. An object may
/// stand on it.
/// @param platform_from_sensor  as told: optical frame to platform frame, metres
/// @return nothing if no surface is seen within 60 mm and 6 degrees of the told one
/// @throws std::invalid_argument  if the frame has another size than the intrinsics say
std::optional<PlatformSurface> measure_platform_surface(
    const DepthFrame& frame, const Intrinsics& intrinsics,
    const Eigen::Isometry3d& platform_from_sensor);

/// How an object stands in one more look than it stood in an earlier one from the same angle.
struct ObjectMove {
  double shift = 0;        ///< metres along the platform, of the middle of what is seen of it
  double shift_sigma = 0;  ///< metres, in the direction of the shift
  double turn = 0;         ///< radians about that middle, counter-clockwise seen from above
  double turn_sigma = 0;   ///< radians; large for an object that looks the same from all sides
};

/// A shift that is too large to be measured, metres: an object that is not found again has this.
inline constexpr double max_measured_shift = 0.02;

/// Measures how an object moved from one look to another.
///
/// Both see the platform at the same angle, so all of the sensor's fixed errors are the same in
/// both. A reading p of the first, moved by R(turn) (p - m) + m + shift, must lie on the surface
/// that the second saw: point-to-plane distances, minimised by Gauss-Newton over the shift along
/// the platform and the turn about its normal, m the middle of the readings (Chen and Medioni
/// 1992).
///
/// @param first  with the pose that tells the platform's surface and axis
/// @param again  a depth image by the same sensor from the same place
/// @param clip   metres, object's frame: around the object
/// @return nothing if the first look saw too little of an object
/// @throws std::invalid_argument  if a frame's size is not that of the intrinsics
std::optional<ObjectMove> measure_move(const Snapshot& first, const DepthFrame& again,
                                       const Box& clip);

/// Adds the finding "moved" of such a look after a turn, if the object moved by more than 1 mm or
/// 0.6 degrees, and three sigma. A move, a slip or a turn that is not whole, which the turn's own
/// findings tell of, explains it, and is not told twice.
void add_move(std::vector<CalibrationFinding>& findings, const ObjectMove& move);

/// Writes how the object had moved at the last look into `folder/scan.json`, as its `last_look`,
/// whole or not at all. All its other keys stay.
/// @throws Error  as `read_scan` and `write_scan`
void write_object_move(const std::filesystem::path& folder, const ObjectMove& move);

/// What scan.json keeps of the last look.
/// @return nothing if there was none
/// @throws Error "scan-missing", "scan-malformed"
std::optional<ObjectMove> read_object_move(const std::filesystem::path& folder);

}  // namespace octurn
