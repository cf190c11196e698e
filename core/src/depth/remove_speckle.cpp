#include "depth/remove_speckle.hpp"

#include <cmath>

namespace octurn {
namespace {

constexpr int min_support = 5;  // of the nine readings in a window

}  // namespace

DepthImage remove_speckle(const DepthImage& image) {
  DepthImage kept{.width = image.width, .height = image.height, .z = {}};
  kept.z.resize(image.z.size());
  for (int v = 1; v + 1 < image.height; ++v) {
    const float* const row = image.row(v);
    float* const kept_row = kept.row(v);
    for (int u = 1; u + 1 < image.width; ++u) {  // without branches, so that it is vectorised
      const float z = row[u];
      int support = 0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          support += std::abs(row[dv * image.width + u + du] - z) <= depth_step_limit ? 1 : 0;
        }
      }
      kept_row[u] = support >= min_support ? z : 0.0F;
    }
  }
  return kept;
}

}  // namespace octurn
