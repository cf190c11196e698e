#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace octurn {

/// What one pixel of a conditioned depth image observes, in the sensor's optical frame, metres.
struct DepthObservation {
  std::array<float, 3> normal = {};  // of the surface's tangent plane, towards the sensor
  float offset = 0;                  // signed distance to that plane is normal . point + offset
  float weight = 0;                  // of the surface; 0: none was observed
  float free_space_depth = 0;        // z up to which the ray is free; 0: unknown
};

/// Minima and maxima of depth over rectangles of pixels, by a mip pyramid: a query reads at most
/// 3 x 3 texels.
class DepthPyramid {
 public:
  /// @param observations  width x height, row by row
  DepthPyramid(std::span<const DepthObservation> observations, int width, int height);

  /// Bounds of what the pixels of a rectangle observe, metres. The pyramid's texels may reach
  /// beyond the rectangle, so they are conservative.
  struct MinMax {
    float min_free = 0;     ///< of `free_space_depth`; 0 if a pixel has none or is no pixel
    float max_free = 0;     ///< of `free_space_depth`
    float min_surface = 0;  ///< the same where there is a surface; the largest float if none
    float max_surface = 0;  ///< the same where there is a surface; 0 if there is none
  };

  /// @param u0,v0,u1,v1  first and last column and row; may lie partly outside the image
  MinMax min_max(int u0, int v0, int u1, int v1) const;

 private:
  /// (min free, min surface, -max free, -max surface): maxima are negated so that one componentwise
  /// minimum merges all four.
  using Bounds = Eigen::Array4f;

  struct Level {
    int width = 0;
    int height = 0;
    std::vector<Bounds> bounds = {};
  };

  static Level coarser(const Level& fine);

  int width_;
  int height_;
  std::vector<Level> levels_ = {};  // level i has texels of 4 << i pixels a side
};

}  // namespace octurn
