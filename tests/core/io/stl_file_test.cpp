#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "octurn/stl.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

const std::array facets{
    Facet{.normal = {0, 0, 1}, .corners = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, .attributes = 0},
    Facet{.normal = {0, 1, 0},
          .corners = {{{1.5F, 2, 3}, {4, 5, 6}, {7, 8, -9}}},
          .attributes = filled_in}};

/// A binary STL file assembled from the format's description: 80 bytes, the count, and for each
/// triangle twelve floats and a 16-bit number, all little-endian.
std::string written_by_hand() {
  std::string bytes = "Octurn, millimetres";
  bytes.resize(80);
  bytes += std::string("\x02\0\0\0", 4);
  for (const Facet& facet : facets) {
    const auto append = [&](float value) {
      std::array<char, 4> raw{};
      std::memcpy(raw.data(), &value, 4);
      bytes.append(raw.data(), 4);
    };
    for (const float component : std::array(facet.normal)) {
      append(component);
    }
    for (const auto& corner : std::array(facet.corners)) {
      for (const float coordinate : corner) {
        append(coordinate);
      }
    }
    bytes += std::string(1, static_cast<char>(facet.attributes)) + std::string(1, '\0');
  }
  return bytes;
}

TEST(Stl, IsTheBinaryFormatByteForByte) {
  EXPECT_EQ(stl_text(facets), written_by_hand());
  EXPECT_EQ(stl_bytes(facets.size()), written_by_hand().size());
}

TEST(Stl, RefusesMoreTrianglesThanItsCountHolds) {
  EXPECT_NO_THROW(stl_header(0xffffffffU));
  EXPECT_EQ(code_thrown_by([] { stl_header(std::uint64_t{1} << 32U); }), "model-too-large");
}

TEST(StlFile, IsTheSameFromPieces) {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  StlFile file(target);
  file.write(std::span(facets).first(1));
  file.write({});
  file.write(std::span(facets).last(1));
  EXPECT_FALSE(std::filesystem::exists(target));  // whole or not at all
  file.commit();
  EXPECT_EQ(content_of(target), written_by_hand());
}

TEST(StlFile, LeavesNothingWithoutACommit) {
  const TemporaryFolder folder;
  { StlFile(folder.path() / "Scan.stl").write(facets); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace octurn
