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

/// 1 inside of the even squares, -1 inside of the odd ones, interpolated at their border.
/// @param width  of the border, squares
double parity(double place, double width) {
  const double border = std::round(place);
  const double side = std::clamp(2 * (place - border) / width, -1.0, 1.0);
  return std::fmod(std::abs(border), 2) < 0.5 ? side : -side;
}

}  // namespace

Vector2d intersect_board(const Eigen::Isometry3d& board_from_camera, const Vector2d& ray) {
  const Vector3d from = board_from_camera.translation();
  const Vector3d way = board_from_camera.linear() * ray.homogeneous();
  return (from - way * (from.z() / way.z())).head<2>();
}

bool is_on_board(const Vector2d& place) {
  return place.x() > -board_margin && place.y() > -board_margin &&
         place.x() < board_columns + board_margin && place.y() < board_rows + board_margin;
}

double board_light(const Vector2d& place, const Vector2d& width) {
  if (!is_on_board(place)) {
    return background;
  }
  if (!(place.x() > 0 && place.y() > 0 && place.x() < board_columns && place.y() < board_rows)) {
    return white;
  }
  const double dark = (1 + parity(place.x(), width.x()) * parity(place.y(), width.y())) / 2;
  return white + dark * (black - white);
}

}  // namespace octurn
