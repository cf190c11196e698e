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
    Names{MeshFormat::ply, ".ply", "application/octet-stream"},  // no media type is registered
    Names{MeshFormat::glb, ".glb", "model/gltf-binary"},
    Names{MeshFormat::threemf, ".3mf", "model/3mf"},
};

}  // namespace

std::optional<MeshFormat> to_mesh_format(std::string_view extension) {
  const auto* const found = std::ranges::find(formats, extension, &Names::extension);
  return found == formats.end() ? std::nullopt : std::optional(found->format);
}

std::string_view media_type(MeshFormat format) {
  return std::ranges::find(formats, format, &Names::format)->media_type;
}

void write_mesh(MeshFormat format, const FacetFile& facets, const std::string& name,
                const std::string& thumbnail, const std::filesystem::path& target,
                std::span<const Rgb> colours) {
  switch (format) {
    case MeshFormat::ply:
      write_ply(facets, target, colours);
      break;
    case MeshFormat::glb:
      write_glb(facets, name, target, colours);
      break;
    case MeshFormat::threemf:
      write_3mf(facets, name, thumbnail, target, colours);
      break;
  }
}

}  // namespace octurn
