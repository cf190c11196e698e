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

constexpr std::size_t min_board_corners = 20;
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

double nearest_distance(const std::vector<Vector2d>& corners,
                        const std::vector<LatticePlace>& places, std::size_t of) {
  double least = 1e9;
  for (const LatticePlace& place : places) {
    if (place.corner != of) {
      least = std::min(least, (corners[place.corner] - corners[of]).norm());
    }
  }
  return least;
}

}  // namespace

BoardView find_board(const Picture& picture) {
  const int side = std::max(1, picture.width / usual_width);
  const GreyImage image = smoothed(reduced(picture, side));
  const std::vector<Vector2d> corners = find_corners(image);
  const std::vector<LatticePlace> places = grow_lattice(corners, find_edges(image, corners));
  if (places.size() < min_board_corners) {
    return {};
  }
  const GreyImage whole = side == 1 ? image : smoothed(reduced(picture, 1));
  BoardView view;
  for (const LatticePlace& place : places) {
    const double distance = side * nearest_distance(corners, places, place.corner);
    const int reach = std::clamp(static_cast<int>(reach_share * distance), least_reach, most_reach);
    // A block's centre lies (side - 1) / 2 pixels from the centre of its first pixel.
    Vector2d pixel = corners[place.corner] * side + Vector2d::Constant((side - 1) / 2.0);
    if (refine_corner(whole, reach, pixel)) {
      view.push_back({.pixel = pixel, .column = place.square.x(), .row = place.square.y()});
    }
  }
  return view.size() < min_board_corners ? BoardView{} : view;
}

}  // namespace octurn
