#include "depth/fit_plane.hpp"

#include <array>
#include <cmath>

namespace octurn {
namespace {

constexpr int reach = fit_window_side / 2;
constexpr int min_samples = 9;

// Separable weights along u and v. Integration averages snapshots, so that a wider window loses
// more by rounding off edges than it gains: with 0.75 and 0.35 beside the middle 36 snapshots lose
// 0.03 mm of accuracy.
constexpr std::array<float, fit_window_side> window{0.05F, 0.35F, 1.0F, 0.35F, 0.05F};

constexpr float min_determinant = 0.05F;  // of the covariance of u and v, pixels^4: 0 on a line

/// Weighted moments of samples (u, v, q), from which a plane q(u, v) is solved.
struct WeightedPlane {
  float w = 0;
  float u = 0;
  float v = 0;
  float q = 0;
  float uu = 0;
  float uv = 0;
  float vv = 0;
  float uq = 0;
  float vq = 0;

  void add(float weight, float at_u, float at_v, float value) {
    w += weight;
    u += weight * at_u;
    v += weight * at_v;
    q += weight * value;
    uu += weight * at_u * at_u;
    uv += weight * at_u * at_v;
    vv += weight * at_v * at_v;
    uq += weight * at_u * value;
    vq += weight * at_v * value;
  }

  /// The normal equations of the centred samples, by Cramer's rule.
  /// @param offset  inverse depth to which the values are relative, 1/m
  std::optional<PlaneFit> solve(float offset, int samples) const {
    const float mean_u = u / w;
    const float mean_v = v / w;
    const float mean_q = q / w;
    const float cov_uu = uu / w - mean_u * mean_u;
    const float cov_uv = uv / w - mean_u * mean_v;
    const float cov_vv = vv / w - mean_v * mean_v;
    const float cov_uq = uq / w - mean_u * mean_q;
    const float cov_vq = vq / w - mean_v * mean_q;
    const float determinant = cov_uu * cov_vv - cov_uv * cov_uv;
    if (determinant < min_determinant) {
      return std::nullopt;
    }
    const float slope_u = (cov_uq * cov_vv - cov_vq * cov_uv) / determinant;
    const float slope_v = (cov_vq * cov_uu - cov_uq * cov_uv) / determinant;
    return PlaneFit{.inverse_depth = offset + mean_q - slope_u * mean_u - slope_v * mean_v,
                    .slope_u = slope_u,
                    .slope_v = slope_v,
                    .samples = samples};
  }
};

}  // namespace

std::vector<float> to_inverse_depth(const DepthImage& image) {
  std::vector<float> inverse_depth(image.z.size());
  for (std::size_t i = 0; i < inverse_depth.size(); ++i) {
    inverse_depth[i] = image.z[i] > 0 ? 1.0F / image.z[i] : 0.0F;
  }
  return inverse_depth;
}

std::optional<PlaneFit> fit_plane(const DepthImage& image, const std::vector<float>& inverse_depth,
                                  int u, int v) {
  const float z = image.at(u, v);
  // Values are relative to the middle's, so that sums of floats keep their precision.
  const float offset = inverse_depth[static_cast<std::size_t>(v * image.width + u)];
  WeightedPlane plane;
  int samples = 0;
  for (int dv = -reach; dv <= reach; ++dv) {
    for (int du = -reach; du <= reach; ++du) {
      if (std::abs(image.at(u + du, v + dv) - z) > depth_step_limit) {
        continue;
      }
      ++samples;
      plane.add(window[static_cast<std::size_t>(du + reach)] *
                    window[static_cast<std::size_t>(dv + reach)],
                static_cast<float>(du), static_cast<float>(dv),
                inverse_depth[static_cast<std::size_t>((v + dv) * image.width + u + du)] - offset);
    }
  }
  return samples < min_samples ? std::nullopt : plane.solve(offset, samples);
}

}  // namespace octurn
