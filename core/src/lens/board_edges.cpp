#include "lens/board_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octurn {
namespace {

using Eigen::Vector2d;

constexpr std::size_t nearest = 12;   // number of candidates for a corner's neighbours
constexpr double min_contrast = 8;    // grey levels, across an edge
constexpr double min_evenness = 0.3;  // minimum over maximum contrast along an edge
constexpr double min_length = 5;      // pixels
constexpr double max_longer = 3;      // ratio of the lengths of opposite edges
constexpr double opposite_cosine = -0.8;

struct Neighbour {
  std::size_t corner = 0;
  double distance = 0;  // pixels
};

std::vector<Neighbour> nearest_corners(std::span<const Vector2d> corners, std::size_t of) {
  std::vector<Neighbour> others;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double distance = (corners[i] - corners[of]).norm();
    if (i != of && distance >= min_length) {
      others.push_back({.corner = i, .distance = distance});
    }
  }
  const std::size_t count = std::min(nearest, others.size());
  std::ranges::partial_sort(others, others.begin() + static_cast<std::ptrdiff_t>(count), {},
                            &Neighbour::distance);
  others.resize(count);
  return others;
}

/// The grey level on the left of the line from one corner to another, less that on its right, where
/// the contrast is lowest; nothing if the line is no edge.
std::optional<double> contrast(const GreyImage& image, const Vector2d& from, const Vector2d& to) {
  const Vector2d way = to - from;
  const Vector2d left(way.y(), -way.x());  // seen along the line; v points down
  const Vector2d aside = left * std::max(0.12, 1.5 / way.norm());
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const double share : {0.2, 0.35, 0.5, 0.65, 0.8}) {
    const Vector2d on_left = from + share * way + aside;
    const Vector2d on_right = from + share * way - aside;
    if (!image.contains(on_left.x(), on_left.y()) || !image.contains(on_right.x(), on_right.y())) {
      return std::nullopt;
    }
    const double step =
        image.bilinear(on_left.x(), on_left.y()) - image.bilinear(on_right.x(), on_right.y());
    least = std::min(least, step);
    most = std::max(most, step);
  }
  if (most < 0) {
    std::swap(least, most);
  }
  const bool is_edge = std::abs(least) >= min_contrast && least * most > 0 &&
                       std::abs(least) >= min_evenness * std::abs(most);
  return is_edge ? std::optional(least) : std::nullopt;
}

/// The nearest neighbour along an axis, and the nearest one in the opposite direction.
CornerEdges::Ends opposite_ends(std::span<const Vector2d> corners, std::size_t of,
                                std::span<const Neighbour> along) {
  CornerEdges::Ends ends;
  if (along.empty()) {
    return ends;
  }
  ends[0] = along.front().corner;
  const Vector2d way = (corners[*ends[0]] - corners[of]).normalized();
  for (const Neighbour& other : along.subspan(1)) {
    const Vector2d back = (corners[other.corner] - corners[of]) / other.distance;
    if (way.dot(back) < opposite_cosine && other.distance < max_longer * along.front().distance) {
      ends[1] = other.corner;
      break;
    }
  }
  return ends;
}

}  // namespace

int CornerEdges::count() const {
  int edges = 0;
  for (const Ends& ends : {light_left, dark_left}) {
    edges += static_cast<int>(std::ranges::count_if(
        ends, [](const std::optional<std::size_t>& end) { return end.has_value(); }));
  }
  return edges;
}

std::vector<CornerEdges> find_edges(const GreyImage& image, std::span<const Vector2d> corners) {
  std::vector<CornerEdges> all;
  for (std::size_t of = 0; of < corners.size(); ++of) {
    std::vector<Neighbour> light;
    std::vector<Neighbour> dark;
    for (const Neighbour& other : nearest_corners(corners, of)) {
      if (const auto step = contrast(image, corners[of], corners[other.corner])) {
        (*step > 0 ? light : dark).push_back(other);
      }
    }
    all.push_back({.light_left = opposite_ends(corners, of, light),
                   .dark_left = opposite_ends(corners, of, dark)});
  }
  return all;
}

}  // namespace octurn
