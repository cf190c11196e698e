#pragma once

#include <filesystem>
#include <span>
#include <stop_token>
#include <vector>

#include "mesh/facet_file.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/model.hpp"

namespace octurn {

/// Computes the colours of the vertices of a model's VertexTable by `vertex_colours`. Memory is
/// that of the table, and about 60 bytes a vertex.
/// @param folder  of the scan that the model was made of
/// @throws Error  as `vertex_colours`; "memory-limit"
std::vector<Rgb> model_colours(const FacetFile& facets, const std::filesystem::path& folder,
                               const Scan& scan, const std::stop_token& stop = {});

/// Checks that a model has as many colours as vertices, which fails if it was rebuilt meanwhile.
/// @param colours  may be empty
/// @throws Error "no-model"
void expect_colours_of(const VertexTable& table, std::span<const Rgb> colours);

}  // namespace octurn
