#pragma once

#include <cstddef>
#include <vector>

#include "mesh/vertex_table.hpp"

namespace octurn {

/// Renders a model as a PNG of 256 x 256 pixels with a transparent background: in clay, seen from
/// the front right and from above, like the page's first view. Memory is 6 MB for any model.
/// @throws Error "read-failed"
std::vector<std::byte> draw_thumbnail(const FacetFile& facets);

}  // namespace octurn
