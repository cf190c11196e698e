#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mesh/facet_file.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// A format that a model can be had in besides STL.
enum class MeshFormat { ply, glb, threemf };

/// The format of files with that extension, such as ".ply".
std::optional<MeshFormat> mesh_format_of(std::string_view extension);

/// The media type of a format.
std::string_view media_type(MeshFormat format);

// Each writer writes the facets of a model, in their order and with the bits of their corners, to a
// file that appears whole or not at all. Memory is that of a VertexTable and of one block.
// `colours` are of the vertices of its VertexTable; without them the file has none.
// All throw Error "disk-full", "write-failed", "read-failed", "memory-limit"; "no-model" if there
// are not as many colours as vertices.

/// Binary little-endian PLY 1.0, millimetres, Z up. The property `filled` of a face is 1 where hole
/// filling has made it.
void write_ply(const FacetFile& facets, const std::filesystem::path& target,
               std::span<const Rgb> colours = {});

/// Binary glTF 2.0. Its positions are the model's in millimetres, Z up; its one node turns and
/// scales them to what glTF has: metres, Y up. Colours are linear there.
void write_glb(const FacetFile& facets, const std::string& name,
               const std::filesystem::path& target, std::span<const Rgb> colours = {});

/// 3MF, core specification 1.3: one object with that name, in millimetres, Z up, standing as it was
/// scanned. Colours are a group of the materials extension 1.2.
/// @param thumbnail  a PNG, which programs show for the file; empty: none
void write_3mf(const FacetFile& facets, const std::string& name, const std::string& thumbnail,
               const std::filesystem::path& target, std::span<const Rgb> colours = {});

/// Writes a file of that format, by its writer above.
void write_mesh(MeshFormat format, const FacetFile& facets, const std::string& name,
                const std::string& thumbnail, const std::filesystem::path& target,
                std::span<const Rgb> colours = {});

}  // namespace octurn
