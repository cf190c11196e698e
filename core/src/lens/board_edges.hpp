#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lens/grey_image.hpp"

namespace octurn {

/// The four edges between squares that meet in a corner. Seen from the corner, both edges along one
/// axis of the board have a light square on their left, both edges along the other axis a dark one.
struct CornerEdges {
  using Ends = std::array<std::optional<std::size_t>, 2>;  ///< corners at two opposite edges' ends

  Ends light_left = {};
  Ends dark_left = {};

  int count() const;
};

/// Finds neighbouring corners. Only between these is the picture an edge all along, dark on one
/// side and light on the other.
/// @param corners  pixels
/// @return one for each corner
std::vector<CornerEdges> find_edges(const GreyImage& image,
                                    std::span<const Eigen::Vector2d> corners);

}  // namespace octurn
