#include "depth/depth_pyramid.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace octurn {
namespace {

constexpr int finest_shift = 2;  // texels of the finest level have 4 x 4 pixels
constexpr int finest_side = 1 << finest_shift;
constexpr int max_texels = 3;  // of a query, along u and along v
constexpr float huge = std::numeric_limits<float>::max();

Eigen::Array4f no_bounds() { return {huge, huge, 0, 0}; }

/// @param u1,v1  one past the last pixel
Eigen::Array4f find_bounds(std::span<const DepthObservation> observations, int width, int u0,
                           int v0, int u1, int v1) {
  DepthPyramid::MinMax bounds{
      .min_free = huge, .max_free = 0, .min_surface = huge, .max_surface = 0};
  for (int v = v0; v < v1; ++v) {
    for (int u = u0; u < u1; ++u) {
      const DepthObservation& observation = observations[static_cast<std::size_t>(v * width + u)];
      const float z = observation.free_space_depth;
      bounds.min_free = std::min(bounds.min_free, z);
      bounds.max_free = std::max(bounds.max_free, z);
      if (observation.weight > 0) {
        bounds.min_surface = std::min(bounds.min_surface, z);
        bounds.max_surface = std::max(bounds.max_surface, z);
      }
    }
  }
  return {bounds.min_free, bounds.min_surface, -bounds.max_free, -bounds.max_surface};
}

}  // namespace

DepthPyramid::DepthPyramid(std::span<const DepthObservation> observations, int width, int height)
    : width_(width), height_(height) {
  Level finest{.width = (width + finest_side - 1) / finest_side,
               .height = (height + finest_side - 1) / finest_side,
               .bounds = {}};
  finest.bounds.reserve(static_cast<std::size_t>(finest.width * finest.height));
  for (int v = 0; v < height; v += finest_side) {
    for (int u = 0; u < width; u += finest_side) {
      finest.bounds.push_back(find_bounds(observations, width, u, v,
                                          std::min(u + finest_side, width),
                                          std::min(v + finest_side, height)));
    }
  }
  levels_.push_back(std::move(finest));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    levels_.push_back(coarser(levels_.back()));
  }
}

DepthPyramid::Level DepthPyramid::coarser(const Level& fine) {
  Level coarse{.width = (fine.width + 1) / 2, .height = (fine.height + 1) / 2, .bounds = {}};
  coarse.bounds.resize(static_cast<std::size_t>(coarse.width * coarse.height), no_bounds());
  for (int v = 0; v < fine.height; ++v) {
    for (int u = 0; u < fine.width; ++u) {
      Bounds& bounds = coarse.bounds[static_cast<std::size_t>(v / 2 * coarse.width + u / 2)];
      bounds = bounds.min(fine.bounds[static_cast<std::size_t>(v * fine.width + u)]);
    }
  }
  return coarse;
}

DepthPyramid::MinMax DepthPyramid::min_max(int u0, int v0, int u1, int v1) const {
  Bounds bounds = no_bounds();
  if (u0 < 0 || v0 < 0 || u1 >= width_ || v1 >= height_) {
    bounds[0] = 0;
    u0 = std::max(u0, 0);
    v0 = std::max(v0, 0);
    u1 = std::min(u1, width_ - 1);
    v1 = std::min(v1, height_ - 1);
  }
  std::size_t level = 0;
  int shift = finest_shift;
  while (level + 1 < levels_.size() &&
         std::max((u1 >> shift) - (u0 >> shift), (v1 >> shift) - (v0 >> shift)) >= max_texels) {
    ++level;
    ++shift;
  }
  // Always 3 x 3 texels, some of them twice: branches on the number needed would be mispredicted.
  static_assert(max_texels == 3);
  const Level& texels = levels_[level];
  const int left = u0 >> shift;
  const int right = u1 >> shift;
  const int middle = std::min(left + 1, right);
  const int top = v0 >> shift;
  const int bottom = v1 >> shift;
  for (const int v : {top, std::min(top + 1, bottom), bottom}) {
    const Bounds* row = &texels.bounds[static_cast<std::size_t>(v * texels.width)];
    bounds = bounds.min(row[left]).min(row[middle]).min(row[right]);
  }
  return {.min_free = bounds[0],
          .max_free = -bounds[2],
          .min_surface = bounds[1],
          .max_surface = -bounds[3]};
}

}  // namespace octurn
