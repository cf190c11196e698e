#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/vertex_table.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// A model to be written to a file. Empty texts are left out of it.
struct MeshModel {
  const FacetFile& facets;
  std::string name = {};
  std::string inventory_number = {};
  std::string author = {};
  std::string licence = {};
  std::string thumbnail = {};         ///< a PNG; empty: none
  std::span<const Rgb> colours = {};  ///< of the VertexTable's vertices; empty: none
};

/// A format for models besides STL: a row of the table from which routes, messages and the page
/// take what they offer.
struct MeshFormat {
  std::string_view extension;  ///< such as ".ply"
  std::string_view media_type;
  bool has_thumbnail;  ///< whether its files hold a picture
  void (*write)(const MeshModel& model, const std::filesystem::path& target);
};
std::span<const MeshFormat> mesh_formats();

/// The format of files with that extension; null if there is none.
const MeshFormat* find_mesh_format(std::string_view extension);

/// The names of files in all formats, for a message: "Scan.3mf, Scan.ply or Scan.glb".
std::string mesh_file_names(const std::string& stem);

/// What is known of the model besides its surface, a line for each: "author Jane Doe".
std::vector<std::string> comment_lines(const MeshModel& model);

// Each writer writes the facets of a model in order, with bit-identical coordinates, to a file that
// appears whole or not at all. Memory is that of a VertexTable and one block of facets. `colours`
// are those of the VertexTable's vertices; empty: the file has none.
// All throw Error "disk-full", "write-failed", "read-failed", "memory-limit"; "no-model" if there
// are not as many colours as vertices.

/// Binary little-endian PLY 1.0, millimetres, Z up. The property `filled` of a face is 1 if hole
/// filling has made it.
void write_ply(const MeshModel& model, const std::filesystem::path& target);

/// Binary glTF 2.0. Positions are in millimetres, Z up; the only node transforms them to the metres
/// and Y up of glTF. Colours are converted to linear, as glTF requires. Author and licence are its
/// copyright, and with the inventory number its extras.
void write_glb(const MeshModel& model, const std::filesystem::path& target);

/// 3MF, core specification 1.3: one object with that name, in millimetres, Z up, standing as it was
/// scanned, with the thumbnail that programs show for the file. Colours are a group of the
/// materials extension 1.2.
void write_3mf(const MeshModel& model, const std::filesystem::path& target);

/// Wavefront OBJ, millimetres, Z up, as text with all digits of the coordinates. Colours follow the
/// coordinates of a vertex, as MeshLab and Blender read them.
void write_obj(const MeshModel& model, const std::filesystem::path& target);

}  // namespace octurn
