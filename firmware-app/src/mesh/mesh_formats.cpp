#include "mesh/mesh_formats.hpp"

#include <algorithm>
#include <array>

namespace octurn {
namespace {

struct Names {
  MeshFormat format;
  std::string_view extension;
  std::string_view media_type;
};

constexpr std::array formats{
    Names{MeshFormat::ply, ".ply", "application/octet-stream"},  // none is registered
    Names{MeshFormat::glb, ".glb", "model/gltf-binary"},
    Names{MeshFormat::threemf, ".3mf", "model/3mf"},
};

}  // namespace

std::optional<MeshFormat> mesh_format_of(std::string_view extension) {
  const auto* const found = std::ranges::find(formats, extension, &Names::extension);
  return found == formats.end() ? std::nullopt : std::optional(found->format);
}

std::string_view media_type(MeshFormat format) {
  return std::ranges::find(formats, format, &Names::format)->media_type;
}

}  // namespace octurn
