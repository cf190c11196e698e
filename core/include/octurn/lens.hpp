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
};

/// Finds focal lengths, principal point and distortion of a lens from views of one flat board
/// (Zhang 2000): a homography of each view, fx and fy in closed form, then all numbers and the
/// boards' poses by Levenberg-Marquardt. The squares' side cancels out. Deterministic.
///
/// It is refused if fewer than 5 views show a board, the boards are within 20 degrees of parallel,
/// sigma of a focal length exceeds 0.3 %, corners were seen in less than 85 % of the cells, the rms
/// exceeds 0.6 pixels at a width of 820, or the distortion is not one-to-one within the picture.
///
/// @param width, height  pixels, of the pictures
LensReport calibrate_lens(std::span<const BoardView> views, int width, int height);

}  // namespace octurn
