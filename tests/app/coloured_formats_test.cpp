// A coloured model has a colour at each vertex in each format.

#include <gtest/gtest.h>
#include <minizip/unzip.h>

#include <array>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/mesh_formats.hpp"
#include "mesh/vertex_table.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

/// The corner cut off a cube, a tetrahedron with three edges of 10 mm.
std::vector<Facet> tetrahedron() {
  const Vertex o{0, 0, 0};
  const Vertex x{10, 0, 0};
  const Vertex y{0, 10, 0};
  const Vertex z{0, 0, 10};
  const float s = 0.577F;
  return {{.normal = {0, 0, -1}, .corners = {o, y, x}},
          {.normal = {0, -1, 0}, .corners = {o, x, z}},
          {.normal = {-1, 0, 0}, .corners = {o, z, y}},
          {.normal = {s, s, s}, .corners = {x, y, z}}};
}

class ColouredFormats : public testing::Test {
 protected:
  ColouredFormats() { put(file("Scan.stl"), stl_text(tetrahedron())); }

  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  FacetFile stl() const { return FacetFile(file("Scan.stl")); }

  TemporaryFolder folder_;
  // Colours of the vertices in the order of the vertex table: o, y, x, z.
  std::vector<Rgb> colours_ = {{0, 0, 0}, {255, 255, 255}, {200, 16, 1}, {188, 188, 188}};
};

TEST_F(ColouredFormats, TheObjHasThemBehindEachPlaceAsShares) {
  write_obj({.facets = stl(), .colours = colours_}, file("Scan.obj"));
  std::istringstream obj(content_of(file("Scan.obj")));
  std::size_t vertices = 0;
  for (std::string line; std::getline(obj, line);) {
    if (!line.starts_with("v ")) {
      continue;
    }
    std::istringstream words(line.substr(1));
    std::array<double, 6> numbers{};
    for (double& number : numbers) {
      ASSERT_TRUE(words >> number) << line;
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(numbers.at(3 + channel) * 255, colours_.at(vertices).at(channel), 0.02) << line;
    }
    ++vertices;
  }
  EXPECT_EQ(vertices, colours_.size());
}

TEST_F(ColouredFormats, ThePlyHasThemBehindEachPlace) {
  write_ply({.facets = stl(), .colours = colours_}, file("Scan.ply"));
  const std::string ply = content_of(file("Scan.ply"));
  const std::string end = "end_header\n";
  const std::size_t begin = ply.find(end) + end.size();
  EXPECT_NE(ply.find("property uchar red\nproperty uchar green\nproperty uchar blue\n"), ply.npos);
  ASSERT_EQ(ply.size(), begin + 4 * (12 + 3) + 4 * (1 + 12 + 1));
  const VertexTable table(stl());
  for (std::size_t i = 0; i < colours_.size(); ++i) {
    Vertex place{};
    std::memcpy(place.data(), &ply[begin + 15 * i], sizeof place);
    EXPECT_EQ(place, table.vertices()[i]);
    EXPECT_EQ(std::memcmp(&ply[begin + 15 * i + 12], colours_[i].data(), 3), 0) << i;
  }
}

TEST_F(ColouredFormats, TheGlbHasThemLinear) {
  write_glb({.facets = stl(), .colours = colours_}, file("Scan.glb"));
  const std::string glb = content_of(file("Scan.glb"));
  std::uint32_t json_bytes = 0;
  std::memcpy(&json_bytes, &glb[12], sizeof json_bytes);
  const auto document = nlohmann::json::parse(glb.substr(20, json_bytes));
  const std::size_t index = document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
  const auto& accessor = document["accessors"][index];
  EXPECT_EQ(accessor["count"], colours_.size());
  EXPECT_EQ(accessor["normalized"], true);
  const auto& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t at = 28 + json_bytes + view["byteOffset"].get<std::size_t>();
  ASSERT_EQ(glb.size(), at + 4 * 4 * sizeof(std::uint16_t));
  std::array<std::array<std::uint16_t, 4>, 4> linear{};
  std::memcpy(linear.data(), &glb[at], sizeof linear);
  EXPECT_EQ(linear[0], (std::array<std::uint16_t, 4>{0, 0, 0, 65535}));
  EXPECT_EQ(linear[1], (std::array<std::uint16_t, 4>{65535, 65535, 65535, 65535}));
  EXPECT_NEAR(linear[3][0] / 65535.0, 0.5029, 0.0001) << "sRGB's middle grey";
}

TEST_F(ColouredFormats, The3mfHasThemInAGroup) {
  write_3mf({.facets = stl(), .colours = colours_}, file("Scan.3mf"));
  const std::unique_ptr<void, decltype(&unzClose)> zip(unzOpen64(file("Scan.3mf").c_str()),
                                                       &unzClose);
  ASSERT_EQ(unzLocateFile(zip.get(), "3D/3dmodel.model", 0), UNZ_OK);
  ASSERT_EQ(unzOpenCurrentFile(zip.get()), UNZ_OK);
  std::string xml(1 << 16, '\0');
  xml.resize(static_cast<std::size_t>(
      unzReadCurrentFile(zip.get(), xml.data(), static_cast<unsigned>(xml.size()))));
  EXPECT_NE(xml.find("<m:colorgroup id=\"2\"><m:color color=\"#000000\"/>"
                     "<m:color color=\"#FFFFFF\"/><m:color color=\"#C81001\"/>"),
            xml.npos);
  EXPECT_NE(xml.find("<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"2\" p1=\"0\" p2=\"1\" p3=\"2\"/>"),
            xml.npos);
}

}  // namespace
}  // namespace octurn
