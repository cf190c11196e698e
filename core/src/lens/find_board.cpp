#include <algorithm>
#include <cmath>
#include <vector>

#include "lens/board_edges.hpp"
#include "lens/board_lattice.hpp"
#include "lens/corner_features.hpp"
#include "lens/grey_image.hpp"
#include "octurn/lens.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;

constexpr int first_reach = 4;  // pixels around a corner, before its squares' size is known
constexpr int least_reach = 3;
constexpr int most_reach = 12;
constexpr double reach_share = 0.5;  // of the distance to the nearest corner

/// The corners of a smoothed image, refined.
std::vector<Vector2d> find_corners(const GreyImage& image) {
  std::vector<Vector2d> corners;
  for (const CornerFeature& feature : corner_features(image)) {
    Vector2d pixel = feature.pixel;
    if (refine_corner(image, first_reach, pixel)) {
      corners.push_back(pixel);
    }
  }
  return corners;
}

double nearest_distance(const BoardView& view, std::size_t of) {
  double least = 1e9;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (i != of) {
      least = std::min(least, (view[i].pixel - view[of].pixel).norm());
    }
  }
  return least;
}

}  // namespace

BoardView find_lattice(const GreyImage& image) {
  const std::vector<Vector2d> corners = find_corners(image);
  BoardView view;
  for (const LatticePlace& place : grow_lattice(corners, find_edges(image, corners))) {
    view.push_back(
        {.pixel = corners[place.corner], .column = place.square.x(), .row = place.square.y()});
  }
  return view;
}

BoardView find_board(const Picture& picture) {
  const int side = std::max(1, picture.width / usual_width);
  const GreyImage image = smoothed(reduced(picture, side));
  const BoardView lattice = find_lattice(image);
  if (lattice.size() < min_board_corners) {
    return {};
  }
  const GreyImage whole = side == 1 ? image : smoothed(reduced(picture, 1));
  BoardView view;
  for (std::size_t i = 0; i < lattice.size(); ++i) {
    const double distance = side * nearest_distance(lattice, i);
    const int reach = std::clamp(static_cast<int>(reach_share * distance), least_reach, most_reach);
    BoardCorner corner = lattice[i];
    corner.pixel = to_whole(corner.pixel, side);
    if (refine_corner(whole, reach, corner.pixel)) {
      view.push_back(corner);
    }
  }
  return view.size() < min_board_corners ? BoardView{} : view;
}

}  // namespace octurn
