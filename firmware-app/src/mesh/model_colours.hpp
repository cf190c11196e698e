#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <stop_token>
#include <vector>

#include "mesh/vertex_table.hpp"
#include "octurn/model.hpp"
#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Computes the colours of the vertices of a model's VertexTable by `vertex_colours`. Memory is
/// that of the table, and about 60 bytes a vertex.
/// @param folder  of the scan that the model was made of
/// @param edits   of the model: a laid or scaled one is seen where the object stood
/// @throws Error  as `vertex_colours`; "memory-limit"
std::vector<Rgb> model_colours(const FacetFile& facets, const std::filesystem::path& folder,
                               const Scan& scan, const ModelEdits& edits = {},
                               const std::stop_token& stop = {});

/// Checks that a model has as many colours as vertices, which fails if it was rebuilt meanwhile.
/// @param colours  may be empty
/// @throws Error "no-model"
void expect_colours_of(const VertexTable& table, std::span<const Rgb> colours);

/// The colour of a vertex by the number of snapshots that saw it: none, 1, 2, 3, 4, 5 or more. The
/// page's legend has the same ones.
inline constexpr std::array<Rgb, 6> colours_of_views{{
    {0xdf, 0xe3, 0xe6},
    {0xb8, 0x32, 0x2a},
    {0xe2, 0x7a, 0x2e},
    {0xee, 0xc3, 0x4a},
    {0x8f, 0xbf, 0x6b},
    {0x1f, 0x8f, 0x72},
}};

/// Computes that colour for the vertices of a model's VertexTable. A snapshot saw a vertex if its
/// reading there is within 5 mm of it, beyond 0.75 m within more by the square of the distance, and
/// the surface faces the sensor at less than 75 degrees. Memory is that of the table, 16 bytes a
/// vertex more, and one snapshot.
/// @param snapshots  of the model, by a depth sensor
/// @param edits      as above
/// @throws Error "memory-limit", "read-failed"; as the source; Stopped
std::vector<Rgb> view_colours(const FacetFile& facets, const SnapshotSource& snapshots,
                              const ModelEdits& edits = {}, const std::stop_token& stop = {});

}  // namespace octurn
