#pragma once

#include <stop_token>
#include <vector>

#include "octurn/stl.hpp"
#include "tsdf/compact_tsdf.hpp"

namespace octurn {

/// Draws the surface observed so far by marching cubes, open where nothing was observed.
///
/// A coarse sample is the mean of the voxels in it that are observed or right behind an observed
/// surface, if they are at least a quarter; it is free if rays passed through at least half. A cube
/// with a corner that is neither has no surface.
///
/// @param base_layer  the lowest layer of voxels whose samples count
/// @param side        of a coarse sample, voxels; at least 1
/// @throws Stopped  between two layers
std::vector<Facet> observed_surface(const CompactTsdf& known, int base_layer, int side,
                                    const std::stop_token& stop = {});

}  // namespace octurn
