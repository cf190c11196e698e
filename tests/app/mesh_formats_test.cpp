// Each format has, to the bit, the triangles of the STL from which it is made.

#include "mesh/mesh_formats.hpp"

#include <gtest/gtest.h>
#include <minizip/unzip.h>
#include <spng.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "mesh/coarse_mesh.hpp"
#include "mesh/thumbnail.hpp"
#include "mesh/vertex_table.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using Triangle = std::array<Vertex, 3>;

std::string content_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

template <typename Value>
Value take(const std::string& bytes, std::size_t& at) {
  Value value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  at += sizeof value;
  return value;
}

/// A ball of 20 mm on the platform in `bands` bands, whose lower half is marked as filled in.
std::vector<Facet> ball(int bands) {
  const auto corner = [&](int band, int sector) -> Vertex {
    const double polar = M_PI * band / bands;
    const double angle = 2 * M_PI * (sector % (2 * bands)) / (2 * bands);
    const bool is_pole = band == 0 || band == bands;
    const double radius = is_pole ? 0 : 10 * std::sin(polar);
    return {static_cast<float>(radius * std::cos(angle)) + 0.0F,
            static_cast<float>(radius * std::sin(angle)) + 0.0F,
            static_cast<float>(10 + 10 * std::cos(polar))};
  };
  std::vector<Facet> facets;
  for (int band = 0; band < bands; ++band) {
    for (int sector = 0; sector < 2 * bands; ++sector) {
      const std::uint16_t attributes = 2 * band < bands ? 0 : filled_in;
      const Vertex a = corner(band, sector);
      const Vertex b = corner(band + 1, sector);
      const Vertex c = corner(band + 1, sector + 1);
      const Vertex d = corner(band, sector + 1);
      const auto middle = [](const Vertex& v) {
        return std::array{v[0] / 10, v[1] / 10, v[2] / 10 - 1};
      };
      if (band > 0) {
        facets.push_back({.normal = middle(a), .corners = {a, b, d}, .attributes = attributes});
      }
      if (band + 1 < bands) {
        facets.push_back({.normal = middle(c), .corners = {b, c, d}, .attributes = attributes});
      }
    }
  }
  return facets;
}

class MeshFormats : public ::testing::Test {
 protected:
  MeshFormats() {
    std::ofstream(folder_.path() / "Scan.stl", std::ios::binary) << stl_text(facets_);
  }

  FacetFile stl() const { return FacetFile(folder_.path() / "Scan.stl"); }
  fs::path file(const std::string& name) const { return folder_.path() / name; }

  void expect_same(const std::vector<Triangle>& triangles) const {
    ASSERT_EQ(triangles.size(), facets_.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const auto corners = facets_[i].corners;  // a copy: a facet's corners are unaligned
      ASSERT_EQ(triangles[i], corners) << i;
    }
  }

  TemporaryFolder folder_;
  std::vector<Facet> facets_ = ball(40);
};

TEST_F(MeshFormats, ListEachCornerOnce) {
  const VertexTable table(stl());
  EXPECT_EQ(table.vertices().size(), 2 + facets_.size() / 2) << "Euler: V - E + F = 2";
  const auto corners = facets_.back().corners;
  EXPECT_EQ(table.vertices()[table.index(corners[1])], corners[1]);
}

TEST_F(MeshFormats, ListNoMoreCornersThanFitIntoTheMemoryOfARequest) {
  std::vector<Facet> apart(800'000);  // 2.4 million corners
  float x = 0;
  for (Facet& facet : apart) {
    facet.corners = {Vertex{++x, 0, 0}, Vertex{x, 1, 0}, Vertex{x, 0, 1}};
  }
  std::ofstream(file("Scan.stl"), std::ios::binary) << stl_text(apart);
  EXPECT_EQ(code_thrown_by([&] { VertexTable{stl()}; }), "memory-limit");
}

TEST_F(MeshFormats, WriteThePlyOfAnStl) {
  write_ply({.facets = stl()}, file("Scan.ply"));
  const std::string ply = content_of(file("Scan.ply"));
  const std::string end = "end_header\n";
  std::size_t at = ply.find(end) + end.size();
  std::smatch counts;
  const std::string head = ply.substr(0, at);
  ASSERT_TRUE(std::regex_search(head, counts, std::regex("vertex (\\d+)[^]*face (\\d+)")));
  std::vector<Vertex> vertices(std::stoul(counts[1]));
  for (Vertex& vertex : vertices) {
    vertex = take<Vertex>(ply, at);
  }
  std::vector<Triangle> triangles(std::stoul(counts[2]));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    ASSERT_EQ(take<std::uint8_t>(ply, at), 3);
    for (Vertex& corner : triangles[i]) {
      corner = vertices.at(take<std::uint32_t>(ply, at));
    }
    ASSERT_EQ(take<std::uint8_t>(ply, at), facets_[i].attributes);
  }
  EXPECT_EQ(at, ply.size());
  expect_same(triangles);
}

TEST_F(MeshFormats, WriteTheObjOfAnStl) {
  write_obj({.facets = stl(), .name = "Hase\n1"}, file("Scan.obj"));
  std::istringstream obj(content_of(file("Scan.obj")));
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::string> others;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line.substr(1));
    if (line.starts_with("v ")) {
      Vertex& vertex = vertices.emplace_back();
      words >> vertex[0] >> vertex[1] >> vertex[2];
    } else if (line.starts_with("f ")) {
      std::array<std::size_t, 3> corners{};
      words >> corners[0] >> corners[1] >> corners[2];
      triangles.push_back(
          {vertices.at(corners[0] - 1), vertices.at(corners[1] - 1), vertices.at(corners[2] - 1)});
    } else {
      others.push_back(line);
    }
  }
  EXPECT_EQ(others, (std::vector<std::string>{"# millimetres, Z up", "# name Hase 1", "o Hase 1"}));
  expect_same(triangles);
}

TEST_F(MeshFormats, AreFoundByTheEndingsOfTheirFiles) {
  EXPECT_EQ(mesh_file_names("Scan"), "Scan.3mf, Scan.ply, Scan.glb or Scan.obj");
  for (const MeshFormat& format : mesh_formats()) {
    ASSERT_EQ(find_mesh_format(format.extension), &format);
    const fs::path written = file("Scan").replace_extension(format.extension);
    const FacetFile facets = stl();
    format.write({.facets = facets, .name = "Hase"}, written);
    EXPECT_GT(fs::file_size(written), 1000U) << format.extension;
  }
  EXPECT_EQ(find_mesh_format(".stl"), nullptr);
}

TEST_F(MeshFormats, WriteTheGlbOfAnStl) {
  write_glb({.facets = stl(), .name = "Hase \"1\""}, file("Scan.glb"));
  const std::string glb = content_of(file("Scan.glb"));
  std::size_t at = 0;
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  at = 4;
  EXPECT_EQ(take<std::uint32_t>(glb, at), 2U);
  EXPECT_EQ(take<std::uint32_t>(glb, at), glb.size());
  const auto json_bytes = take<std::uint32_t>(glb, at);
  EXPECT_EQ(json_bytes % 4, 0U);
  at += 4;
  const auto document = nlohmann::json::parse(glb.substr(at, json_bytes));
  at += json_bytes;
  const auto buffer_bytes = take<std::uint32_t>(glb, at);
  at += 4;
  EXPECT_EQ(buffer_bytes, glb.size() - at);
  EXPECT_EQ(document["nodes"][0]["name"], "Hase \"1\"");
  EXPECT_EQ(document["accessors"][1]["max"][2], 20);
  const std::size_t count = document["accessors"][0]["count"];
  std::size_t vertices = at + count * 4;
  std::vector<Triangle> triangles(count / 3);
  for (Triangle& triangle : triangles) {
    for (Vertex& corner : triangle) {
      std::size_t place = vertices + take<std::uint32_t>(glb, at) * sizeof(Vertex);
      corner = take<Vertex>(glb, place);
    }
  }
  expect_same(triangles);
}

/// The content of an archive's files by name.
std::map<std::string, std::string> unzipped(const fs::path& archive) {
  std::map<std::string, std::string> files;
  const std::unique_ptr<void, decltype(&unzClose)> zip(unzOpen64(archive.c_str()), &unzClose);
  for (int status = unzGoToFirstFile(zip.get()); status == UNZ_OK;
       status = unzGoToNextFile(zip.get())) {
    std::array<char, 200> name{};
    unz_file_info64 info{};
    unzGetCurrentFileInfo64(zip.get(), &info, name.data(), name.size(), nullptr, 0, nullptr, 0);
    std::string content(info.uncompressed_size, '\0');
    unzOpenCurrentFile(zip.get());
    EXPECT_EQ(unzReadCurrentFile(zip.get(), content.data(), static_cast<unsigned>(content.size())),
              static_cast<int>(content.size()));
    EXPECT_EQ(unzCloseCurrentFile(zip.get()), UNZ_OK) << "its checksum";
    files.emplace(name.data(), std::move(content));
  }
  return files;
}

/// The values of an XML attribute, in order.
template <typename Number>
std::vector<Number> values(const std::string& xml, const std::string& attribute) {
  std::vector<Number> found;
  const std::string begin = " " + attribute + "=\"";
  for (std::size_t at = xml.find(begin); at != xml.npos; at = xml.find(begin, at + 1)) {
    found.push_back(static_cast<Number>(std::strtof(xml.c_str() + at + begin.size(), nullptr)));
  }
  return found;
}

TEST_F(MeshFormats, WriteThe3mfOfAnStl) {
  write_3mf({.facets = stl(), .name = "Hase & <Igel>", .thumbnail = "a picture"}, file("Scan.3mf"));
  const auto files = unzipped(file("Scan.3mf"));
  ASSERT_EQ(files.size(), 4U);
  EXPECT_EQ(files.at("Metadata/thumbnail.png"), "a picture");
  const std::string& xml = files.at("3D/3dmodel.model");
  EXPECT_NE(xml.find("unit=\"millimeter\""), xml.npos);
  EXPECT_NE(xml.find("name=\"Hase &amp; &lt;Igel&gt;\""), xml.npos);
  const std::string vertices = xml.substr(0, xml.find("<triangles>"));
  const auto x = values<float>(vertices, "x");
  const auto y = values<float>(vertices, "y");
  const auto z = values<float>(vertices, "z");
  const auto v1 = values<std::size_t>(xml, "v1");
  const auto v2 = values<std::size_t>(xml, "v2");
  const auto v3 = values<std::size_t>(xml, "v3");
  const auto corner = [&](std::size_t i) { return Vertex{x.at(i), y.at(i), z.at(i)}; };
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < v1.size(); ++i) {
    triangles.push_back({corner(v1[i]), corner(v2.at(i)), corner(v3.at(i))});
  }
  expect_same(triangles);
}

TEST_F(MeshFormats, TellWhoseTheModelIs) {
  const FacetFile facets = stl();
  const MeshModel model{.facets = facets,
                        .name = "Hase",
                        .inventory_number = "<17> & 3",
                        .author = "Jane\nend_header",
                        .licence = "CC BY 4.0"};
  for (const MeshFormat& format : mesh_formats()) {
    format.write(model, file("told"));
    const std::string told = format.extension == ".3mf"
                                 ? unzipped(file("told")).at("3D/3dmodel.model")
                                 : content_of(file("told"));
    const auto has = [&](const std::string& text) { return told.find(text) != told.npos; };
    if (format.extension == ".3mf") {
      EXPECT_TRUE(has(R"(<metadata name="Designer">Jane end_header</metadata>)"));
      EXPECT_TRUE(has(R"(<metadata name="LicenseTerms">CC BY 4.0</metadata>)"));
      EXPECT_TRUE(has(R"(<metadata name="octurn:InventoryNumber">&lt;17&gt; &amp; 3</metadata>)"));
      EXPECT_TRUE(has(R"(xmlns:octurn=")"));
    } else if (format.extension == ".glb") {
      EXPECT_TRUE(has(R"("copyright":"Jane\nend_header, CC BY 4.0")"));
      EXPECT_TRUE(has(R"("inventory_number":"<17> & 3")"));
    } else {
      const std::string begin = format.extension == ".ply" ? "\ncomment " : "\n# ";
      EXPECT_TRUE(has(begin + "name Hase" + begin + "inventory number <17> & 3" + begin +
                      "author Jane end_header" + begin + "licence CC BY 4.0\n"));
    }
    format.write({.facets = facets, .name = "Hase"}, file("told"));
    const std::string silent = format.extension == ".3mf"
                                   ? unzipped(file("told")).at("3D/3dmodel.model")
                                   : content_of(file("told"));
    for (const char* const word : {"author", "opyright", "Designer", "LicenseTerms", "nventory"}) {
      EXPECT_EQ(silent.find(std::string(word) + "\""), silent.npos) << format.extension << word;
      EXPECT_EQ(silent.find(std::string(word) + " "), silent.npos) << format.extension << word;
    }
  }
}

TEST_F(MeshFormats, HaveNothingOfAnStlThatIsCutShort) {
  fs::resize_file(file("Scan.stl"), 84 + 50);
  EXPECT_EQ(code_thrown_by([&] { stl(); }), "no-model");
  EXPECT_EQ(code_thrown_by([&] { FacetFile(file("nothing")); }), "no-model");
}

TEST_F(MeshFormats, DrawABallAsADiscThatIsBrighterWhereTheLightIs) {
  const std::vector<std::byte> png = draw_thumbnail(stl());
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> context(spng_ctx_new(0),
                                                                    &spng_ctx_free);
  spng_set_png_buffer(context.get(), png.data(), png.size());
  std::vector<std::uint8_t> pixels(256 * 256 * 4);
  ASSERT_EQ(spng_decode_image(context.get(), pixels.data(), pixels.size(), SPNG_FMT_RGBA8, 0), 0);
  std::size_t opaque = 0;
  for (std::size_t i = 3; i < pixels.size(); i += 4) {
    opaque += pixels[i] == 255 ? 1 : 0;
  }
  const double radius = 256 * (1 - 2 * 0.06) / 2;
  EXPECT_NEAR(static_cast<double>(opaque), M_PI * radius * radius, 0.03 * M_PI * radius * radius);
  const auto red = [&](std::size_t x, std::size_t y) { return pixels[(y * 256 + x) * 4]; };
  EXPECT_EQ(pixels[3], 0) << "nothing is in the corner";
  EXPECT_GT(red(110, 60), red(150, 220)) << "the light comes from above";
  EXPECT_GT(red(50, 110), red(206, 110) + 30) << "and from the left, as in the page's 3D view";
}

Eigen::Vector3d to_point(const Vertex& corner) {
  return Eigen::Vector3f(corner.data()).cast<double>();
}

/// Distance from the centre of the ball, which stands on the platform; millimetres.
double distance_to_middle(const Vertex& corner) {
  return (to_point(corner) - Eigen::Vector3d(0, 0, 10)).norm();
}

TEST_F(MeshFormats, MakeACoarseMeshOfABallThatIsSmallerByLittleAndFilledInBelowTheMiddleOnly) {
  const std::vector<Facet> coarse = coarse_mesh(stl(), 500);
  EXPECT_LE(coarse.size(), 500U);
  EXPECT_GT(coarse.size(), 200U) << "no coarser than asked for";
  const double cell = std::sqrt(3 * 4 * M_PI * 100 / 200.0);  // millimetres, at 200 facets
  double six_volumes = 0;
  for (const Facet& facet : coarse) {
    const auto corners = facet.corners;
    for (const Vertex& corner : corners) {
      EXPECT_LE(distance_to_middle(corner), 10.001) << "a mean of points on the ball";
      EXPECT_GT(distance_to_middle(corner), 10 - cell);
      EXPECT_TRUE(facet.attributes != filled_in || to_point(corner).z() < 10 + cell);
    }
    six_volumes += to_point(corners[0]).dot(to_point(corners[1]).cross(to_point(corners[2])));
  }
  const double volume = 4.0 / 3 * M_PI * 1000;
  EXPECT_GT(six_volumes / 6, 0.85 * volume) << "closed, and turned outwards";
  EXPECT_LT(six_volumes / 6, volume);
}

TEST_F(MeshFormats, MakeACoarseMeshOfFacetsWithoutArea) {
  const auto coarse = [&](const std::vector<Facet>& facets, std::size_t max_facets) {
    std::ofstream(file("Scan.stl"), std::ios::binary) << stl_text(facets);
    return coarse_mesh(stl(), max_facets).size();
  };
  std::vector<Facet> collinear;
  for (int i = 1; i <= 1000; ++i) {
    const auto x = static_cast<float>(i);
    collinear.push_back({.corners = {Vertex{0, 0, 0}, Vertex{x, 0, 0}, Vertex{2 * x, 0, 0}}});
  }
  EXPECT_LE(coarse(collinear, 100), 100U);
  EXPECT_GT(coarse(collinear, 100), 50U) << "no coarser than asked for";
  EXPECT_EQ(coarse({Facet{}, Facet{}}, 16), 0U) << "all corners are one point";
}

}  // namespace
}  // namespace octurn
