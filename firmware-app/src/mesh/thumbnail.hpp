#pragma once

#include <cstddef>
#include <vector>

#include "mesh/facet_file.hpp"

namespace octurn {

/// A picture of a model, 256 x 256, as a PNG with a transparent ground: clay, seen from the front
/// at the right and from above, as the page shows it first. Memory is 6 MB, whatever the model.
/// @throws Error "read-failed"
std::vector<std::byte> draw_thumbnail(const FacetFile& facets);

}  // namespace octurn
