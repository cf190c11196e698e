#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lens/grey_image.hpp"

namespace octurn {

/// The edges of squares that leave a corner. On a board those along one of its axes, in both
/// directions, have light on their left, those along the other axis darkness.
struct CornerEdges {
  using Ends = std::array<std::optional<std::size_t>, 2>;  ///< corners; opposite to each other

  Ends light_left = {};
  Ends dark_left = {};

  int count() const;
};

/// Which corners are neighbours: between them the picture is an edge all along, dark on one side
/// and light on the other, as it is for no other pair of a board's corners.
/// @param corners  pixels
std::vector<CornerEdges> find_edges(const GreyImage& image,
                                    std::span<const Eigen::Vector2d> corners);

}  // namespace octurn
