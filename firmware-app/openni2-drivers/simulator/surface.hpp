#pragma once

#include "simulator/rasterise.hpp"

namespace octurn {

/// The properties of a surface that determine a depth camera's noise and losses at a pixel.
struct Surface {
  float inverse_depth = 0;  // 1/m
  float cosine = 1;         // of the angle between the surface's normal and the ray
  bool is_edge = false;     // a neighbour belongs to another surface
};

/// True if the inverse depths of two neighbours belong to different surfaces: they are 1.5 % apart
/// (10 mm at 0.65 m), or only one of them is seen.
bool is_edge(float a, float b);

/// The surface that a pixel of a picture of the default intrinsics sees.
Surface surface_at(const InverseDepth& picture, int u, int v);

}  // namespace octurn
