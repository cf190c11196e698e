#include "simulator/mesh_file.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "octurn/stl.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

constexpr Corners first = {{{0, 0, 0}, {100, 0, 0}, {0, 200, 0}}};
constexpr Corners second = {{{0, 0, 50}, {100, 0, 50}, {0, 200, 50}}};

std::string binary_stl(const std::vector<Corners>& facets) {
  std::string bytes(80, 'x');
  const auto count = static_cast<std::uint32_t>(facets.size());
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  for (const Corners& corners : facets) {
    const Facet facet = {.corners = corners};
    bytes.append(reinterpret_cast<const char*>(&facet), sizeof facet);
  }
  return bytes;
}

constexpr const char* text_stl = R"(solid two plates
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1e2 +0 0.0
      vertex 0 200 0
    endloop
  endfacet
  facet normal 0 0 1
    outer loop
      vertex 0 0 50
      vertex 100 0 50
      vertex 0 200 50
    endloop
  endfacet
endsolid two plates
)";

/// The position of a triangle's corner (0, 1, 2), millimetres.
Eigen::Vector3f corner_mm(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
  return 1000 * mesh.vertices[mesh.triangles[triangle][corner]];
}

void expect_two_plates(const Mesh& mesh) {
  ASSERT_EQ(mesh.triangles.size(), 2U);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    EXPECT_TRUE(corner_mm(mesh, 0, corner).isApprox(Eigen::Vector3f(first[corner].data())));
    EXPECT_TRUE(corner_mm(mesh, 1, corner).isApprox(Eigen::Vector3f(second[corner].data())));
  }
}

TEST(MeshFile, ReadsBinaryStl) {
  expect_two_plates(parse_mesh(binary_stl({first, second}), "a.stl"));
}

TEST(MeshFile, ReadsTextStl) { expect_two_plates(parse_mesh(text_stl, "a.stl")); }

TEST(MeshFile, ReadsABinaryStlThatCallsItselfSolid) {
  std::string bytes = binary_stl({first, second});
  bytes.replace(0, 5, "solid");

  expect_two_plates(parse_mesh(bytes, "a.stl"));
}

TEST(MeshFile, RefusesABinaryStlCutShortAnywhereOrWithMoreBehind) {
  const std::string whole = binary_stl({first, second});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(code_thrown_by([&] { parse_mesh(whole.substr(0, size), "a.stl"); }), "mesh-malformed")
        << size;
  }
  const Error error = error_thrown_by([&] { parse_mesh(whole + "x", "a.stl"); });
  EXPECT_STREQ(error.what(),
               "a.stl: 185 bytes do not hold the 2 triangles that its header promises");
}

TEST(MeshFile, RefusesATextStlCutShortAnywhere) {
  const std::string whole = text_stl;
  const std::size_t end = whole.find("endsolid") + std::strlen("endsolid");
  for (std::size_t size = 0; size < end; ++size) {
    EXPECT_EQ(code_thrown_by([&] { parse_mesh(whole.substr(0, size), "a.stl"); }), "mesh-malformed")
        << size;
  }
  const Error error =
      error_thrown_by([&] { parse_mesh(whole.substr(0, whole.find("+0")) + "x", "a.stl"); });
  EXPECT_STREQ(error.what(), "a.stl: line 5: \"x\" is no number");
}

TEST(MeshFile, RefusesWhatHasNoTriangle) {
  EXPECT_EQ(code_thrown_by([] { parse_mesh(binary_stl({}), "a.stl"); }), "mesh-malformed");
  EXPECT_EQ(code_thrown_by([] { parse_mesh("solid\nendsolid\n", "a.stl"); }), "mesh-malformed");
  EXPECT_EQ(code_thrown_by([] { parse_mesh("", "a.stl"); }), "mesh-malformed");
}

TEST(MeshFile, RefusesCornersThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(), -1e30F, 20000.0F}) {
    Corners corners = first;
    corners[1][2] = bad;
    EXPECT_EQ(code_thrown_by([&] {
                parse_mesh(binary_stl({second, corners}), "a.stl");
              }),
              "mesh-malformed")
        << bad;
  }
}

TEST(MeshFile, NamesAFileThatCannotBeRead) {
  const TemporaryFolder folder;
  const std::string missing = (folder.path() / "missing.stl").string();
  const Error error = error_thrown_by([&] { read_mesh(missing); });
  EXPECT_EQ(error.what(), missing + ": cannot be read");
  EXPECT_EQ(code_thrown_by([&] { read_mesh(folder.path().string()); }), "mesh-malformed");
}

TEST(MeshFile, StandsInTheMiddleOfThePlatform) {
  Mesh mesh = parse_mesh(binary_stl({first, second}), "a.stl");

  stand_on_platform(mesh);

  EXPECT_TRUE(corner_mm(mesh, 0, 0).isApprox(Eigen::Vector3f(-50, -100, 0)));
  EXPECT_TRUE(corner_mm(mesh, 1, 2).isApprox(Eigen::Vector3f(-50, 100, 50)));
}

}  // namespace
}  // namespace octurn
