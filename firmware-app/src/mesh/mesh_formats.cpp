#include "mesh/mesh_formats.hpp"

#include <algorithm>
#include <array>

namespace octurn {
namespace {

constexpr std::array formats{
    MeshFormat{".3mf", "model/3mf", true,
               [](const MeshModel& model, const std::filesystem::path& target) {
                 write_3mf(model.facets, model.name, model.thumbnail, target, model.colours);
               }},
    MeshFormat{".ply", "application/octet-stream", false,  // no media type is registered
               [](const MeshModel& model, const std::filesystem::path& target) {
                 write_ply(model.facets, target, model.colours);
               }},
    MeshFormat{".glb", "model/gltf-binary", false,
               [](const MeshModel& model, const std::filesystem::path& target) {
                 write_glb(model.facets, model.name, target, model.colours);
               }},
    MeshFormat{".obj", "model/obj", false,
               [](const MeshModel& model, const std::filesystem::path& target) {
                 write_obj(model.facets, model.name, target, model.colours);
               }},
};

}  // namespace

std::span<const MeshFormat> mesh_formats() { return formats; }

const MeshFormat* find_mesh_format(std::string_view extension) {
  const auto* const found = std::ranges::find(formats, extension, &MeshFormat::extension);
  return found == formats.end() ? nullptr : found;
}

std::string mesh_file_names(const std::string& stem) {
  std::string names;
  for (const MeshFormat& format : formats) {
    names += (names.empty() ? "" : &format == &formats.back() ? " or " : ", ") + stem;
    names += format.extension;
  }
  return names;
}

}  // namespace octurn
