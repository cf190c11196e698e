#include "simulator/printed_board.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Grey levels.
constexpr double black = 28;
constexpr double white = 205;
constexpr double background = 92;

constexpr double soft_edge = 1.6;  // pixels, as the lens and a pixel's area blur it

/// 1 inside of the even squares, -1 inside of the odd ones, interpolated at their border.
/// @param width  of the border, squares
double parity(double place, double width) {
  const double border = std::round(place);
  const double side = std::clamp(2 * (place - border) / width, -1.0, 1.0);
  return std::fmod(std::abs(border), 2) < 0.5 ? side : -side;
}

}  // namespace

Eigen::Isometry3d camera_from_board(const BoardHold& hold, const Vector2d& middle) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(hold.distance / board_square * middle.homogeneous());
  pose.rotate(Eigen::AngleAxisd(hold.about_x, Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(hold.about_y, Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(hold.about_z, Vector3d::UnitZ()));
  pose.translate(Vector3d(-board_columns / 2.0, -board_rows / 2.0, 0));
  return pose;
}

Vector2d intersect_board(const Eigen::Isometry3d& board_from_camera, const Vector2d& ray) {
  const Vector3d from = board_from_camera.translation();
  const Vector3d way = board_from_camera.linear() * ray.homogeneous();
  return (from - way * (from.z() / way.z())).head<2>();
}

bool is_on_board(const Vector2d& place) {
  return place.x() > -board_margin && place.y() > -board_margin &&
         place.x() < board_columns + board_margin && place.y() < board_rows + board_margin;
}

double board_light(const Eigen::Isometry3d& board_from_camera, const Vector2d& ray,
                   const Vector2d& place, const Vector2d& pixel) {
  if (!is_on_board(place)) {
    return background;
  }
  if (!(place.x() > 0 && place.y() > 0 && place.x() < board_columns && place.y() < board_rows)) {
    return white;
  }
  const Vector2d right = intersect_board(board_from_camera, ray + Vector2d(pixel.x(), 0)) - place;
  const Vector2d below = intersect_board(board_from_camera, ray + Vector2d(0, pixel.y())) - place;
  const Vector2d width = soft_edge * (right.cwiseAbs() + below.cwiseAbs());
  const double dark = (1 + parity(place.x(), width.x()) * parity(place.y(), width.y())) / 2;
  return white + dark * (black - white);
}

}  // namespace octurn
