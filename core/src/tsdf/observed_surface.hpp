#pragma once

#include <stop_token>
#include <vector>

#include "octurn/stl.hpp"
#include "tsdf/compact_tsdf.hpp"

namespace octurn {

/// The surface of what was observed so far, by marching cubes: smooth, and open where nothing was
/// seen.
///
/// A coarse sample is the mean of the voxels that it covers and that were observed or lie right
/// behind what was, if these are a quarter of it; or it is free, if rays passed through half of it.
/// A cube with a corner that is neither has no surface.
///
/// @param base_layer  the lowest layer of voxels whose samples count
/// @param side        of a coarse sample, voxels; at least 1
/// @throws Stopped  between two layers
std::vector<Facet> observed_surface(const CompactTsdf& known, int base_layer, int side,
                                    const std::stop_token& stop = {});

}  // namespace octurn
