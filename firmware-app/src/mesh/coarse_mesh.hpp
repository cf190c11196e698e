#pragma once

#include <cstddef>
#include <vector>

#include "mesh/facet_file.hpp"

namespace octurn {

/// A mesh of a model's shape with few facets, for a first sight of it: the vertices in each cell of
/// a grid become their mean, and facets between three cells remain (vertex clustering, Rossignac
/// and Borrel 1993). Walls thinner than a cell become one sheet, so it is no model to print.
/// Memory is some 200 bytes for each facet of the result.
/// @param max_facets  of the result, 16 or more
/// @throws Error "read-failed"
std::vector<Facet> coarse_mesh(const FacetFile& facets, std::size_t max_facets);

}  // namespace octurn
