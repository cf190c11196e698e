#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "laser/find_line.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Where one laser's line was seen at one stop: the rays of the camera that meet it, freed from the
/// lens's distortion.
struct LineProfile {
  struct Ray {
    float x = 0;  ///< the ray is (x, y, 1), optical frame
    float y = 0;
    std::int32_t next = -1;  ///< index of the ray that continues the line in the next row, or -1
  };

  std::vector<Ray> rays = {};  ///< row by row, in each from left to right
  /// Index of the first ray of each row of the picture, and behind the last row's last ray.
  std::vector<std::int32_t> rows = {};

  std::span<const Ray> row(int v) const {
    const auto i = static_cast<std::size_t>(v);
    return std::span(rays).subspan(static_cast<std::size_t>(rows[i]),
                                   static_cast<std::size_t>(rows[i + 1] - rows[i]));
  }
};

LineProfile to_profile(std::span<const LineSample> samples, const Intrinsics& lens,
                       const LaserCamera& camera);

/// Where a ray meets a laser's plane, optical frame, metres: not a number if it does not, before
/// the camera and within its reach.
Eigen::Vector3d meet(const LineProfile::Ray& ray, const Laser& laser);

}  // namespace octurn
