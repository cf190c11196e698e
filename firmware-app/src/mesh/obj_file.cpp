// Wavefront OBJ, appendix B1 of the Advanced Visualizer's manual; colours after the coordinates are
// a custom of its users.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "mesh/mesh_formats.hpp"
#include "mesh/model_colours.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/file.hpp"
#include "one_line.hpp"

namespace octurn {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 16U;
constexpr double full = 255;  // of a colour's channel

/// Text that goes to a file in blocks.
class TextBlock {
 public:
  explicit TextBlock(AtomicFile& file) : file_(file) {}

  void add(std::string_view text) { text_ += text; }

  /// @param number  is written with as few digits as identify it
  template <typename Number>
  void add_number(Number number) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    text_ += ' ';
    text_.append(digits.data(), end);
  }

  void end_line() {
    text_ += '\n';
    if (text_.size() >= block_bytes) {
      flush();
    }
  }

  void flush() {
    file_.write(std::as_bytes(std::span(text_)));
    text_.clear();
  }

 private:
  AtomicFile& file_;
  std::string text_ = {};
};

/// The name without line feeds, which would end its line.
float to_share(std::uint8_t channel) {
  return static_cast<float>(std::round(channel / full * 10'000) / 10'000);
}

}  // namespace

void write_obj(const MeshModel& model, const std::filesystem::path& target) {
  const std::span<const Rgb> colours = model.colours;
  const VertexTable table(model.facets);
  expect_colours_of(table, colours);
  AtomicFile file(target);
  TextBlock text(file);
  text.add("# millimetres, Z up");
  text.end_line();
  for (const std::string& line : comment_lines(model)) {
    text.add("# " + line);
    text.end_line();
  }
  text.add("o " + to_one_line(model.name));
  text.end_line();
  for (std::size_t i = 0; i < table.vertices().size(); ++i) {
    text.add("v");
    for (const float coordinate : table.vertices()[i]) {
      text.add_number(coordinate);
    }
    if (!colours.empty()) {
      for (const std::uint8_t channel : colours[i]) {
        text.add_number(to_share(channel));
      }
    }
    text.end_line();
  }
  model.facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      text.add("f");
      for (const Vertex& corner : corners) {
        text.add_number(table.index(corner) + 1);
      }
      text.end_line();
    }
  });
  text.flush();
  file.commit();
}

}  // namespace octurn
