#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "laser/find_line.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// One laser's line at one stop: the camera's rays to it, undistorted.
struct LineProfile {
  struct Ray {
    float x = 0;  ///< the ray is (x, y, 1), optical frame
    float y = 0;
    std::int32_t next = -1;  ///< index of the ray that continues the line in the next row, or -1
  };

  std::vector<Ray> rays = {};  ///< sorted by row, then column
  /// Index of the first ray of each row of the picture; the last entry is the number of rays.
  std::vector<std::int32_t> rows = {};

  std::span<const Ray> row(int v) const {
    const auto i = static_cast<std::size_t>(v);
    return std::span(rays).subspan(static_cast<std::size_t>(rows[i]),
                                   static_cast<std::size_t>(rows[i + 1] - rows[i]));
  }
};

LineProfile to_profile(std::span<const LineSample> samples, const Intrinsics& lens,
                       const LaserCamera& camera);

/// The intersection of a ray and a laser's plane, optical frame, metres; NaN if they are nearly
/// parallel or meet outside 0.03 to 3 m in front of the camera.
Eigen::Vector3d meet(const LineProfile::Ray& ray, const Laser& laser);

}  // namespace octurn
