#include "mesh/mesh_formats.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "one_line.hpp"

namespace octurn {
namespace {

constexpr std::array formats{
    MeshFormat{".3mf", "model/3mf", true, write_3mf},
    MeshFormat{".ply", "application/octet-stream", false,
               write_ply},  // no media type is registered
    MeshFormat{".glb", "model/gltf-binary", false, write_glb},
    MeshFormat{".obj", "model/obj", false, write_obj},
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

std::vector<std::string> comment_lines(const MeshModel& model) {
  std::vector<std::string> lines;
  for (const auto& [what, text] :
       {std::pair("name ", &model.name), std::pair("inventory number ", &model.inventory_number),
        std::pair("author ", &model.author), std::pair("licence ", &model.licence)}) {
    if (!text->empty()) {
      lines.push_back(what + to_one_line(*text));
    }
  }
  return lines;
}

}  // namespace octurn
