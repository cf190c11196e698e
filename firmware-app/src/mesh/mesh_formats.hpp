#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mesh/facet_file.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// A format for models besides STL.
enum class MeshFormat { ply, glb, threemf };

/// The format of files with that extension, such as ".ply".
std::optional<MeshFormat> to_mesh_format(std::string_view extension);

/// The media type of a format.
std::string_view media_type(MeshFormat format);

// Each writer writes the facets of a model in order, with bit-identical coordinates, to a file that
// appears whole or not at all. Memory is that of a VertexTable and one block of facets. `colours`
// are those of the VertexTable's vertices; empty: the file has none.
// All throw Error "disk-full", "write-failed", "read-failed", "memory-limit"; "no-model" if there
// are not as many colours as vertices.

/// Binary little-endian PLY 1.0, millimetres, Z up. The property `filled` of a face is 1 if hole
/// filling has made it.
void write_ply(const FacetFile& facets, const std::filesystem::path& target,
               std::span<const Rgb> colours = {});

/// Binary glTF 2.0. Positions are in millimetres, Z up; the only node transforms them to the metres
/// and Y up of glTF. Colours are converted to linear, as glTF requires.
void write_glb(const FacetFile& facets, const std::string& name,
               const std::filesystem::path& target, std::span<const Rgb> colours = {});

/// 3MF, core specification 1.3: one object with that name, in millimetres, Z up, standing as it was
/// scanned. Colours are a group of the materials extension 1.2.
/// @param thumbnail  a PNG, which programs show for the file; empty: none
void write_3mf(const FacetFile& facets, const std::string& name, const std::string& thumbnail,
               const std::filesystem::path& target, std::span<const Rgb> colours = {});

/// Calls the writer of that format.
void write_mesh(MeshFormat format, const FacetFile& facets, const std::string& name,
                const std::string& thumbnail, const std::filesystem::path& target,
                std::span<const Rgb> colours = {});

}  // namespace octurn
