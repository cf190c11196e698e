#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// An inner corner of a chessboard in a picture: where two black and two white squares meet.
struct BoardCorner {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< (0, 0) is the middle of the top left pixel
  /// Position on the board in squares, from an arbitrary origin. Columns and rows are oriented as X
  /// and Y of the optical frame are.
  int column = 0;
  int row = 0;
};

/// The corners that one picture shows.
using BoardView = std::vector<BoardCorner>;

/// Finds the corners of a chessboard of which at least a part is in the picture. The board's size
/// is not needed: a lens can be calibrated without knowing which part of the board is seen.
///
/// Candidates are ChESS features (Bennett and Lasenby 2014). Two are neighbours if the picture
/// between them is an edge, dark on one side and light on the other; neighbours make a lattice.
/// Each corner is refined to the point at which all gradients around it are perpendicular to the
/// direction to it (Foerstner and Guelch 1987).
///
/// @return sorted by row, then column; empty if fewer than 20 corners are connected
BoardView find_board(const Picture& picture);

/// Position and orientation of a board in a picture.
struct BoardPlace {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();   ///< pixels: mean of the corners
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of length one, away from the camera
  double square = 0;                                  ///< pixels: mean side of the squares
};

/// Estimates a board's place, with the lens's distortion neglected.
/// @param view  not empty
BoardPlace place_board(const BoardView& view, const Intrinsics& lens);

/// Intrinsics and radial distortion of a camera. k1 and k2 are those of `LaserCamera`.
struct CameraLens {
  Intrinsics intrinsics = {};  ///< `depth_unit` is not used
  double k1 = 0;
  double k2 = 0;
};

/// A picture is divided into lens_cells x lens_cells cells, in each of which a corner is wanted.
inline constexpr int lens_cells = 6;

/// For each cell, row by row: whether a corner was seen in it.
using LensCoverage = std::array<bool, std::size_t{lens_cells} * lens_cells>;

/// Adds the cells of one view. @param width, height  of the picture, pixels
void add_view(LensCoverage& coverage, const BoardView& view, int width, int height);

/// A board's pose in one of several views.
struct FoundBoard {
  std::size_t view = 0;
  /// X of the board's frame counts columns, Y rows; lengths are in squares.
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// A camera's lens, as solved from views of a board.
struct LensReport {
  bool accepted = false;
  std::string reason = {};  ///< why it was refused, for people; empty if accepted
  CameraLens lens = {};     ///< also of a refused one, if there were enough views
  CameraLens sigma = {};    ///< standard deviations of the lens's numbers
  int views = 0;            ///< used
  int corners = 0;          ///< used, of all views; outliers are left out
  double rms = 0;           ///< pixels, of the reprojection errors
  double tilt = 0;          ///< radians, the largest angle between two of the boards
  LensCoverage coverage = {};
  std::vector<FoundBoard> boards = {};  ///< of the views used
};

enum class PixelShape {
  any,     ///< fx and fy are found each
  square,  ///< fx = fy
};

/// How a lens is solved, and judged.
struct LensRules {
  PixelShape shape = PixelShape::any;
  double max_rms = 0.6;  ///< pixels, at a width of 820
};

/// Finds focal lengths, principal point and distortion of a lens from views of one flat board
/// (Zhang 2000): a homography of each view, fx and fy in closed form, then all numbers and the
/// boards' poses by Levenberg-Marquardt. The squares' side cancels out. Deterministic.
///
/// It is refused if fewer than 5 views show a board, the boards are within 20 degrees of parallel,
/// sigma of a focal length exceeds 0.3 %, corners were seen in less than 85 % of the cells, the rms
/// exceeds the limit, or the distortion is not one-to-one within the picture.
///
/// @param width, height  pixels, of the pictures
LensReport calibrate_lens(std::span<const BoardView> views, int width, int height,
                          const LensRules& rules = {});

/// The same as `find_board` for the infrared picture of a sensor that projects dots, also where
/// these are the only light.
///
/// The gaps between dots are closed, and the picture is smoothed and reduced, until `find_board`'s
/// lattice appears. Then a model of four squares is fitted to the picture about each corner of the
/// lattice, found or not: as many of its dots as possible count. A corner is kept if its squares
/// alternate like the others, with at least 0.7 of their contrast. Corners are found within 0.4
/// pixels (standard deviation) where dots are the only light.
BoardView find_dotted_board(const Picture& picture);

/// A depth that a sensor reports near a corner of a board.
struct BoardDepth {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< of the depth image
  double inverse_depth = 0;                         ///< 1/m, as reported
};

/// A board that is held still before a depth sensor.
struct DepthBoardView {
  BoardView corners = {};               ///< in the infrared picture
  std::vector<BoardDepth> depths = {};  ///< in the depth image
};

/// A pixel of the depth image shows what the infrared picture shows this far to the right and
/// below, pixels: about half of the window of 9 x 9 or 9 x 7 pixels that a Kinect v1 is believed
/// to correlate. 4.8 and 3.9 are said to be measured by Konolige and Mihelich, "Technical
/// description of Kinect calibration"; ROS's drivers have 5 and 4, "from 9x7 correlation window".
inline const Eigen::Vector2d infrared_shift{4.8, 3.9};

/// Takes the depths near a board's corners: of each, the mean of the readings within 4 pixels.
/// @param sensor  as the sensor tells
/// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
std::vector<BoardDepth> board_depths(const BoardView& corners, const DepthFrame& frame,
                                     const Intrinsics& sensor);

/// The optics of a depth sensor, as solved from views of a board.
struct DepthOpticsReport {
  LensReport lens = {};      ///< of the infrared camera; its verdict and reason count for both
  SolvedOptics optics = {};  ///< if accepted
  Eigen::Vector2d shift = infrared_shift;  ///< of the infrared picture, as found, pixels
  double depth_rms = 0;                    ///< 1/m, of the reported inverse depths, after the fit
  int depths = 0;                          ///< used
};

/// Finds the optics of a depth sensor: the lens of its infrared camera as `calibrate_lens` does,
/// then scale and offset of its depths, and the infrared picture's shift. The last three are the
/// least squares of reported inverse depths less those of the boards that were found, with priors:
/// 0 +- 0.01 1/m of the offset, `infrared_shift` +- 1 pixel. A tilted board's depth changes from
/// pixel to pixel, and so shows the shift.
///
/// It is refused as `calibrate_lens` refuses a lens, and if fewer than 5 views have depths, or if
/// the scale is more than 10 % off.
///
/// @param side  metres, of the board's squares
DepthOpticsReport calibrate_depth_optics(std::span<const DepthBoardView> views, int width,
                                         int height, double side);

}  // namespace octurn
