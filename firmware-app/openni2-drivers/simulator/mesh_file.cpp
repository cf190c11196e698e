#include "simulator/mesh_file.hpp"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include "octurn/error.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::size_t header_bytes = 80;  // of a binary STL, then the number of its facets
constexpr std::size_t facets_at = header_bytes + sizeof(std::uint32_t);
constexpr std::uintmax_t max_bytes = 512U << 20U;
constexpr float max_coordinate = 10.0F;  // metres; a larger object stands on no platform

[[noreturn]] void malformed(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::mesh_malformed, name + ": " + what,
              "Give an STL file, binary or text, in millimetres, Z up.");
}

/// Splits a text into words and counts its lines for error messages.
class Words {
 public:
  Words(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  /// The next word of this line; empty at its end.
  std::string_view next() {
    const std::size_t begin = text_.find_first_not_of(" \t\r\v\f");
    text_.remove_prefix(std::min(begin, text_.size()));
    const std::string_view word = text_.substr(0, text_.find_first_of(" \t\r\v\f\n"));
    text_.remove_prefix(word.size());
    return word;
  }

  /// Goes to the next line. @return false at the end of the text
  bool next_line() {
    const std::size_t end = text_.find('\n');
    text_.remove_prefix(end == text_.npos ? text_.size() : end + 1);
    ++line_;
    return !text_.empty();
  }

  /// The first word of the next line that has one; empty at the end of the text.
  std::string_view next_statement() {
    while (next_line()) {
      if (const std::string_view word = next(); !word.empty()) {
        return word;
      }
    }
    return {};
  }

  float number() {
    std::string_view word = next();
    if (word.starts_with('+')) {
      word.remove_prefix(1);
    }
    float value = 0;
    const auto read = std::from_chars(word.begin(), word.end(), value);
    if (read.ec != std::errc() || read.ptr != word.end() || word.empty()) {
      fail("\"" + std::string(word) + "\" is no number");
    }
    return value;
  }

  Eigen::Vector3f point() {
    const float x = number();
    const float y = number();
    const float z = number();
    return {x, y, z};
  }

  [[noreturn]] void fail(const std::string& what) const {
    malformed(name_, "line " + std::to_string(line_) + ": " + what);
  }

 private:
  std::string_view text_;
  const std::string& name_;
  int line_ = 1;
};

Mesh parse_binary_stl(std::string_view bytes) {
  Mesh mesh;
  for (std::size_t at = facets_at; at < bytes.size(); at += sizeof(Facet)) {
    Facet facet;
    std::memcpy(&facet, bytes.data() + at, sizeof facet);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& corner : facet.corners) {
      mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// One facet of a text STL, after its word `facet`.
void parse_text_facet(Words& words, Mesh& mesh) {
  if (words.next_statement() != "outer") {
    words.fail("expected \"outer loop\"");
  }
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    if (words.next_statement() != "vertex") {
      words.fail("expected \"vertex\"");
    }
    mesh.vertices.push_back(words.point());
  }
  if (words.next_statement() != "endloop" || words.next_statement() != "endfacet") {
    words.fail("expected \"endloop\", then \"endfacet\"");
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
}

Mesh parse_text_stl(std::string_view text, const std::string& name) {
  Mesh mesh;
  Words words(text, name);
  for (;;) {
    const std::string_view word = words.next_statement();
    if (word == "facet") {
      parse_text_facet(words, mesh);
    } else if (word != "endsolid") {
      words.fail("expected \"facet\" or \"endsolid\"");
    } else if (const std::string_view after = words.next_statement(); after.empty()) {
      return mesh;
    } else if (after != "solid") {
      words.fail("expected another \"solid\" or the end");
    }
  }
}

void check(const Mesh& mesh, const std::string& name) {
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Eigen::Vector3f& vertex = mesh.vertices[corner];
      if (!(vertex.cwiseAbs().maxCoeff() <= max_coordinate) || !vertex.allFinite()) {
        malformed(name, "a corner is not finite or farther than " +
                            std::to_string(static_cast<int>(max_coordinate)) + " m from zero");
      }
    }
  }
  if (mesh.triangles.empty()) {
    malformed(name, "holds no triangle");
  }
}

/// The number of facets that the header of a binary STL declares, if there is a header.
std::optional<std::uint32_t> promised_facets(std::string_view bytes) {
  if (bytes.size() < facets_at) {
    return std::nullopt;
  }
  std::uint32_t facets = 0;
  std::memcpy(&facets, bytes.data() + header_bytes, sizeof facets);
  return facets;
}

Mesh parse(std::string_view bytes, const std::string& name) {
  const std::optional<std::uint32_t> facets = promised_facets(bytes);
  if (facets && bytes.size() == facets_at + std::size_t{*facets} * sizeof(Facet)) {
    return parse_binary_stl(bytes);
  }
  if (bytes.starts_with("solid")) {
    return parse_text_stl(bytes, name);
  }
  malformed(name, facets ? std::to_string(bytes.size()) + " bytes do not hold the " +
                               std::to_string(*facets) + " triangles that its header promises"
                         : "too short for an STL");
}

}  // namespace

Mesh parse_mesh(std::string_view bytes, const std::string& name) {
  Mesh mesh = parse(bytes, name);
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    for (float& coordinate : vertex) {
      coordinate = static_cast<float>(metres_from_mm(static_cast<double>(coordinate)));
    }
  }
  check(mesh, name);
  return mesh;
}

Mesh read_mesh(const std::string& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) {
    malformed(file, "cannot be read");
  }
  if (size > max_bytes) {
    malformed(file, "is larger than " + std::to_string(max_bytes >> 20U) + " MB");
  }
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
    malformed(file, "cannot be read");
  }
  return parse_mesh(bytes, file);
}

void stand_on_platform(Mesh& mesh) {
  Eigen::AlignedBox3f bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      bounds.extend(mesh.vertices[corner]);
    }
  }
  const Eigen::Vector3f foot(bounds.center().x(), bounds.center().y(), bounds.min().z());
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex -= foot;
  }
}

}  // namespace octurn
