#include "mesh/model_colours.hpp"

#include "octurn/error.hpp"

namespace octurn {

std::vector<Rgb> model_colours(const FacetFile& facets, const std::filesystem::path& folder,
                               const Scan& scan, const std::stop_token& stop) {
  const VertexTable table(facets);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(facets.count());
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      triangles.push_back(
          {table.index(corners[0]), table.index(corners[1]), table.index(corners[2])});
    }
  });
  return vertex_colours(folder, scan, {.vertices = table.vertices(), .triangles = triangles}, stop);
}

void expect_colours_of(const VertexTable& table, std::span<const Rgb> colours) {
  if (!colours.empty() && colours.size() != table.vertices().size()) {
    throw Error(ErrorCode::no_model, "the model was built anew while its colours were written",
                "Download it again.");
  }
}

}  // namespace octurn
