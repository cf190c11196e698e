#pragma once

#include <string>
#include <string_view>

#include "simulator/mesh.hpp"

namespace octurn {

/// Reads an STL file, binary or text, in millimetres with Z up.
/// @throws Error "mesh-malformed"
Mesh read_mesh(const std::string& file);

/// The same from a file's bytes. @param name  of the file, for messages
Mesh parse_mesh(std::string_view bytes, const std::string& name);

/// Moves a mesh onto the platform: its bounding box's centre to the axis, its lowest point to the
/// surface. Does not scale it.
void stand_on_platform(Mesh& mesh);

}  // namespace octurn
