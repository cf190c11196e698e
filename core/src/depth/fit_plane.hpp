#pragma once

#include <optional>
#include <vector>

#include "depth/depth_image.hpp"

namespace octurn {

/// A plane in inverse depth, 1/z = inverse_depth + slope_u du + slope_v dv around a pixel.
///
/// A plane in space is linear in u and v there, and a sensor that measures disparity has the same
/// noise everywhere (Khoshelham and Elberink 2012).
struct PlaneFit {
  float inverse_depth = 0;  // at the pixel, 1/m
  float slope_u = 0;        // 1/m a pixel
  float slope_v = 0;
  int samples = 0;  // readings that it was fitted to
};

/// Side of the window that a plane is fitted in, pixels.
inline constexpr int fit_window_side = 5;

/// 1/z of each reading, 1/m; 0 where there is none.
std::vector<float> to_inverse_depth(const DepthImage& image);

/// Fits a plane to the readings of a 5 x 5 window that lie within `depth_step_limit` of its middle,
/// by weighted least squares.
///
/// @param u,v  at least two pixels inside the image, with a reading
/// @return nothing where fewer than nine readings agree, or all lie on a line
std::optional<PlaneFit> fit_plane(const DepthImage& image, const std::vector<float>& inverse_depth,
                                  int u, int v);

}  // namespace octurn
