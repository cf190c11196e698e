// Binary glTF 2.0: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, section 4.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "mesh/mesh_formats.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::uint32_t magic = 0x46546C67;  // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A;
constexpr std::uint32_t binary_chunk = 0x004E4942;
constexpr int type_float = 5126;
constexpr int type_uint = 5125;
constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;
constexpr double metres_in_mm = 0.001;
constexpr std::size_t heads = 12 + 8 + 8;  // of the file and of its two chunks

struct Bounds {
  Vertex min = {};
  Vertex max = {};
};

Bounds bounds_of(std::span<const Vertex> vertices) {
  Bounds bounds{vertices.front(), vertices.front()};
  for (const Vertex& vertex : vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.min[axis] = std::min(bounds.min[axis], vertex[axis]);
      bounds.max[axis] = std::max(bounds.max[axis], vertex[axis]);
    }
  }
  return bounds;
}

/// What the buffer holds: first the indices, then the positions.
std::string description(std::uint64_t index_bytes, std::span<const Vertex> vertices,
                        const std::string& name) {
  const auto [min, max] = bounds_of(vertices);
  const double half = std::numbers::sqrt2 / 2;  // a quarter of a turn about X: Z up becomes Y up
  const json node{{"mesh", 0},
                  {"name", name},
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
  const json all{
      {"asset", {{"version", "2.0"}, {"generator", "Octurn"}}},
      {"scene", 0},
      {"scenes", json::array({json{{"nodes", json::array({0})}}})},
      {"nodes", json::array({node})},
      {"meshes", json::array({json{{"primitives", json::array({primitive})}}})},
      {"materials", json::array({material})},
      {"accessors", json::array({indices, positions})},
      {"bufferViews", json::array({index_view, position_view})},
      {"buffers", json::array({json{{"byteLength", index_bytes + vertices.size_bytes()}}})}};
  std::string text = all.dump(-1, ' ', false, json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');  // a chunk ends at a multiple of four bytes
  return text;
}

}  // namespace

void write_glb(const FacetFile& facets, const std::string& name,
               const std::filesystem::path& target) {
  const VertexTable table(facets);
  const std::span<const Vertex> vertices = table.vertices();
  const std::uint64_t index_bytes = facets.count() * 3 * sizeof(std::uint32_t);
  const std::string text = description(index_bytes, vertices, name);
  const std::uint64_t buffer_bytes = index_bytes + vertices.size_bytes();
  const auto length = static_cast<std::uint32_t>(heads + text.size() + buffer_bytes);
  AtomicFile file(target);
  const std::array head{magic, std::uint32_t{2}, length, static_cast<std::uint32_t>(text.size()),
                        json_chunk};
  file.write(std::as_bytes(std::span(head)));
  file.write(std::as_bytes(std::span(text)));
  const std::array chunk{static_cast<std::uint32_t>(buffer_bytes), binary_chunk};
  file.write(std::as_bytes(std::span(chunk)));
  std::vector<std::uint32_t> indices;
  facets.read([&](std::span<const Facet> block) {
    indices.clear();
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // which are not aligned in a facet
      for (const Vertex& corner : corners) {
        indices.push_back(table.index(corner));
      }
    }
    file.write(std::as_bytes(std::span(indices)));
  });
  file.write(std::as_bytes(vertices));
  file.commit();
}

}  // namespace octurn
