// Binary glTF 2.0: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, section 4.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "mesh/mesh_formats.hpp"
#include "mesh/model_colours.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::uint32_t magic = 0x46546C67;  // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;
constexpr std::uint32_t binary_chunk = 0x004E4942;
constexpr int type_float = 5126;
constexpr int type_ushort = 5123;
constexpr int type_uint = 5125;
constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;
constexpr double metres_in_mm = 0.001;
constexpr std::size_t heads = 12 + 8 + 8;  // bytes: headers of the file and of its two chunks

struct Bounds {
  Vertex min = {};
  Vertex max = {};
};

Bounds make_bounds(std::span<const Vertex> vertices) {
  Bounds bounds{vertices.front(), vertices.front()};
  for (const Vertex& vertex : vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.min[axis] = std::min(bounds.min[axis], vertex[axis]);
      bounds.max[axis] = std::max(bounds.max[axis], vertex[axis]);
    }
  }
  return bounds;
}

/// Linear red, green, blue and opacity. 16 bits each, as 8 have too few dark levels.
using LinearColour = std::array<std::uint16_t, 4>;

/// The linear value of each 8-bit sRGB level (inverse transfer function of IEC 61966-2-1).
std::array<std::uint16_t, 256> linear_levels() {
  std::array<std::uint16_t, 256> levels{};
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double encoded = static_cast<double>(i) / 255;
    const double linear =
        encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    levels[i] = static_cast<std::uint16_t>(std::lround(65535 * linear));
  }
  return levels;
}

std::vector<LinearColour> linear(std::span<const Rgb> colours) {
  const auto levels = linear_levels();
  std::vector<LinearColour> all;
  all.reserve(colours.size());
  for (const auto& [r, g, b] : colours) {
    all.push_back({levels[r], levels[g], levels[b], 65535});
  }
  return all;
}

/// Adds vertex colours to a glTF document. In the buffer they follow the positions.
void add_colours(json& all, std::size_t count) {
  const std::uint64_t at = all["buffers"][0]["byteLength"];
  const std::uint64_t bytes = count * sizeof(LinearColour);
  all["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = all["accessors"].size();
  all["accessors"].push_back({{"bufferView", all["bufferViews"].size()},
                              {"componentType", type_ushort},
                              {"normalized", true},
                              {"count", count},
                              {"type", "VEC4"}});
  all["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", at}, {"byteLength", bytes}, {"target", array_buffer}});
  all["buffers"][0]["byteLength"] = at + bytes;
  all["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json::array({1, 1, 1, 1});
}

/// The asset of a glTF document: who made the model, and what may be done with it.
json asset(const MeshModel& model) {
  json all{{"version", "2.0"}, {"generator", "Octurn"}};
  for (const auto& [key, text] :
       {std::pair("inventory_number", &model.inventory_number), std::pair("author", &model.author),
        std::pair("licence", &model.licence)}) {
    if (!text->empty()) {
      all["extras"][key] = *text;
    }
  }
  const bool has_both = !model.author.empty() && !model.licence.empty();
  const std::string copyright = model.author + (has_both ? ", " : "") + model.licence;
  if (!copyright.empty()) {
    all["copyright"] = copyright;
  }
  return all;
}

/// The glTF document, as text. Its buffer holds the indices, the positions, and the colours if
/// there are any.
std::string description(const MeshModel& model, std::uint64_t index_bytes,
                        std::span<const Vertex> vertices) {
  const auto [min, max] = make_bounds(vertices);
  const double half = std::numbers::sqrt2 / 2;  // a quarter of a turn about X: Z up becomes Y up
  const json node{{"mesh", 0},
                  {"name", model.name},
                  {"rotation", json::array({-half, 0, 0, half})},
                  {"scale", json::array({metres_in_mm, metres_in_mm, metres_in_mm})}};
  const json primitive{{"attributes", {{"POSITION", 1}}}, {"indices", 0}, {"material", 0}};
  const json material{{"name", "clay"},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", json::array({0.69, 0.65, 0.56, 1})},
                        {"metallicFactor", 0},
                        {"roughnessFactor", 0.8}}}};
  const json indices{{"bufferView", 0},
                     {"componentType", type_uint},
                     {"count", index_bytes / 4},
                     {"type", "SCALAR"}};
  const json positions{{"bufferView", 1},
                       {"componentType", type_float},
                       {"count", vertices.size()},
                       {"type", "VEC3"},
                       {"min", min},
                       {"max", max}};
  const json index_view{
      {"buffer", 0}, {"byteLength", index_bytes}, {"target", element_array_buffer}};
  const json position_view{{"buffer", 0},
                           {"byteOffset", index_bytes},
                           {"byteLength", vertices.size_bytes()},
                           {"target", array_buffer}};
  json all{{"asset", asset(model)},
           {"scene", 0},
           {"scenes", json::array({json{{"nodes", json::array({0})}}})},
           {"nodes", json::array({node})},
           {"meshes", json::array({json{{"primitives", json::array({primitive})}}})},
           {"materials", json::array({material})},
           {"accessors", json::array({indices, positions})},
           {"bufferViews", json::array({index_view, position_view})},
           {"buffers", json::array({json{{"byteLength", index_bytes + vertices.size_bytes()}}})}};
  if (!model.colours.empty()) {
    add_colours(all, model.colours.size());
  }
  std::string text = all.dump(-1, ' ', false, json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');  // a chunk ends at a multiple of four bytes
  return text;
}

}  // namespace

void write_glb(const MeshModel& model, const std::filesystem::path& target) {
  const std::span<const Rgb> colours = model.colours;
  const VertexTable table(model.facets);
  expect_colours_of(table, colours);
  const std::span<const Vertex> vertices = table.vertices();
  const std::vector<LinearColour> linear_colours = linear(colours);
  const std::uint64_t index_bytes = model.facets.count() * 3 * sizeof(std::uint32_t);
  const std::string text = description(model, index_bytes, vertices);
  const std::uint64_t buffer_bytes =
      index_bytes + vertices.size_bytes() + std::span(linear_colours).size_bytes();
  const auto length = static_cast<std::uint32_t>(heads + text.size() + buffer_bytes);
  AtomicFile file(target);
  const std::array head{magic, std::uint32_t{2}, length, static_cast<std::uint32_t>(text.size()),
                        json_chunk};
  file.write(std::as_bytes(std::span(head)));
  file.write(std::as_bytes(std::span(text)));
  const std::array chunk{static_cast<std::uint32_t>(buffer_bytes), binary_chunk};
  file.write(std::as_bytes(std::span(chunk)));
  std::vector<std::uint32_t> indices;
  model.facets.read([&](std::span<const Facet> block) {
    indices.clear();
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      for (const Vertex& corner : corners) {
        indices.push_back(table.index(corner));
      }
    }
    file.write(std::as_bytes(std::span(indices)));
  });
  file.write(std::as_bytes(vertices));
  file.write(std::as_bytes(std::span(linear_colours)));
  file.commit();
}

}  // namespace octurn
