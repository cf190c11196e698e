#pragma once

#include <cstddef>
#include <vector>

#include "mesh/vertex_table.hpp"

namespace octurn {

/// Simplifies a mesh for a fast first view by vertex clustering (Rossignac and Borrel 1993): the
/// vertices in each cell of a grid become their mean, and facets between three cells remain. Walls
/// thinner than a cell become one sheet, so the result is not for printing. Memory is about 200
/// bytes for each facet of the result.
/// @param max_facets  of the result, 16 or more
/// @throws Error "read-failed"
std::vector<Facet> coarse_mesh(const FacetFile& facets, std::size_t max_facets);

}  // namespace octurn
