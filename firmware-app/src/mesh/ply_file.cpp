#include <cstring>
#include <vector>

#include "mesh/mesh_formats.hpp"
#include "mesh/model_colours.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

#pragma pack(push, 1)
struct ColouredVertex {
  Vertex place = {};
  Rgb colour = {};
};
struct Face {
  std::uint8_t corners = 3;
  std::array<std::uint32_t, 3> indices = {};
  std::uint8_t filled = 0;
};
#pragma pack(pop)

std::string header(const MeshModel& model, std::size_t vertices) {
  std::string comments = "comment millimetres, Z up\n";
  for (const std::string& line : comment_lines(model)) {
    comments += "comment " + line + '\n';
  }
  const std::string colour = model.colours.empty() ? ""
                                                   : "\nproperty uchar red\nproperty uchar green"
                                                     "\nproperty uchar blue";
  return "ply\nformat binary_little_endian 1.0\n" + comments + "element vertex " +
         std::to_string(vertices) + "\nproperty float x\nproperty float y\nproperty float z" +
         colour + "\nelement face " + std::to_string(model.facets.count()) +
         "\nproperty list uchar uint vertex_indices\nproperty uchar filled\nend_header\n";
}

std::vector<ColouredVertex> coloured(std::span<const Vertex> vertices,
                                     std::span<const Rgb> colours) {
  std::vector<ColouredVertex> all;
  all.reserve(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    all.push_back({.place = vertices[i], .colour = colours[i]});
  }
  return all;
}

}  // namespace

void write_ply(const MeshModel& model, const std::filesystem::path& target) {
  const std::span<const Rgb> colours = model.colours;
  const VertexTable table(model.facets);
  expect_colours_of(table, colours);
  AtomicFile file(target);
  const std::string head = header(model, table.vertices().size());
  file.write(std::as_bytes(std::span(head)));
  if (colours.empty()) {
    file.write(std::as_bytes(table.vertices()));
  } else {
    const std::vector<ColouredVertex> vertices = coloured(table.vertices(), colours);
    file.write(std::as_bytes(std::span(vertices)));
  }
  std::vector<Face> faces;
  model.facets.read([&](std::span<const Facet> block) {
    faces.clear();
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      const std::array<std::uint32_t, 3> indices{table.index(corners[0]), table.index(corners[1]),
                                                 table.index(corners[2])};
      const bool is_filled = facet.attributes == filled_in;
      faces.push_back({.indices = indices, .filled = static_cast<std::uint8_t>(is_filled ? 1 : 0)});
    }
    file.write(std::as_bytes(std::span(faces)));
  });
  file.commit();
}

}  // namespace octurn
