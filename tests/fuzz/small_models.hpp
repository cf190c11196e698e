#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Ends the fuzzer with this input.
inline void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

inline void require_one_line(const Error& error) {
  require(std::string_view(error.what()).find('\n') == std::string_view::npos);
}

/// Whether a model of the scan takes milliseconds.
inline bool is_small(const Scan& scan) {
  constexpr int max_pixels = 32 * 32;
  constexpr std::size_t max_shots = 3;
  return scan.intrinsics.width * scan.intrinsics.height <= max_pixels &&
         scan.shots.size() <= max_shots;
}

/// Makes a model by each method, all of whose numbers are finite.
/// @throws Error  if there is none
inline void make_models(const Scan& scan, const SnapshotSource& snapshots) {
  for (const Method method : {Method::solid, Method::intersection}) {
    ReconstructOptions options{.method = method,
                               .leaf_size = 1.0 / 64,
                               .clip = model_clip(scan),
                               .placements = placements(scan)};
    fit_to_scan(options, scan);
    const auto reconstruction = make_reconstructor(options);
    reconstruction->add(snapshots);
    reconstruction->surface({}, [](std::span<const Facet> facets) {
      for (const Facet& facet : facets) {
        const auto corners = facet.corners;  // a copy: a facet's members are not aligned
        for (const std::array<float, 3>& corner : corners) {
          require(std::isfinite(corner[0]) && std::isfinite(corner[1]) && std::isfinite(corner[2]));
        }
      }
    });
  }
}

}  // namespace octurn
