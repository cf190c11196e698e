#pragma once

#include <string>
#include <string_view>

#include "simulator/mesh.hpp"

namespace octurn {

/// Reads a mesh in millimetres with Z up from a file: binary STL, text STL or, if its name ends in
/// `.obj`, Wavefront OBJ. @throws Error "mesh-malformed"
Mesh read_mesh(const std::string& file);

/// The same from a file's bytes; `name` is what messages call it.
Mesh parse_mesh(std::string_view bytes, const std::string& name);

/// Moves a mesh onto the platform: the middle of its bounding box on the axis, its lowest point on
/// the surface. Its size stays, whether it fits or not.
void stand_on_platform(Mesh& mesh);

}  // namespace octurn
