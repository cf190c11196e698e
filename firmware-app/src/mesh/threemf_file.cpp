// 3MF core specification 1.3: https://github.com/3MFConsortium/spec_core

#include <array>
#include <charconv>
#include <string>
#include <utility>

#include "mesh/mesh_formats.hpp"
#include "mesh/model_colours.hpp"
#include "mesh/vertex_table.hpp"
#include "one_line.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">)"
    R"(<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>)"
    R"(<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>)"
    R"(<Default Extension="png" ContentType="image/png"/></Types>
)";

constexpr std::string_view relationships_begin =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
    R"(<Relationship Target="/3D/3dmodel.model" Id="model" )"
    R"(Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)";
constexpr std::string_view thumbnail_relationship =
    R"(<Relationship Target="/Metadata/thumbnail.png" Id="thumbnail" )"
    R"(Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"/>)";

constexpr std::size_t part_bytes = std::size_t{64} << 10U;

/// Escapes text for XML. Control characters, which XML cannot contain, are left out.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= ' ') {
          result += c;
        }
    }
  }
  return result;
}

/// XML that is written into an archive in parts.
class XmlStream {
 public:
  explicit XmlStream(ZipWriter& zip) : zip_(zip) {}

  XmlStream& operator<<(std::string_view text) {
    text_ += text;
    if (text_.size() >= part_bytes) {
      flush();
    }
    return *this;
  }

  /// Appends the shortest text that parses to the same number.
  template <typename Number>
  XmlStream& number(Number value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }

  void flush() {
    zip_.write(text_);
    text_.clear();
  }

 private:
  ZipWriter& zip_;
  std::string text_ = {};
};

constexpr std::string_view own_namespace = R"( xmlns:octurn="urn:x-octurn")";
constexpr std::string_view materials =
    R"( xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02")";

/// Writes a colour group, with the colour of each vertex at the vertex's index.
void write_colours(XmlStream& xml, std::span<const Rgb> colours) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  xml << R"(<m:colorgroup id="2">)";
  for (const Rgb& colour : colours) {
    std::string text = "#";
    for (const std::uint8_t level : colour) {
      text += {digits[level / 16U], digits[level % 16U]};
    }
    xml << "<m:color color=\"" << text << "\"/>";
  }
  xml << "</m:colorgroup>";
}

void write_triangles(XmlStream& xml, const FacetFile& facets, const VertexTable& table,
                     std::span<const Rgb> colours) {
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      const std::array<std::uint32_t, 3> indices{table.index(corners[0]), table.index(corners[1]),
                                                 table.index(corners[2])};
      (xml << "<triangle v1=\"").number(indices[0]);
      (xml << "\" v2=\"").number(indices[1]);
      (xml << "\" v3=\"").number(indices[2]);
      if (!colours.empty()) {
        (xml << "\" pid=\"2\" p1=\"").number(indices[0]);
        (xml << "\" p2=\"").number(indices[1]);
        (xml << "\" p3=\"").number(indices[2]);
      }
      xml << "\"/>";
    }
  });
}

/// Names without a namespace are those of the core specification, section 3.4.1, which has none for
/// an inventory number.
void write_metadata(XmlStream& xml, const MeshModel& model) {
  for (const auto& [name, text] :
       {std::pair("Title", &model.name), std::pair("Designer", &model.author),
        std::pair("LicenseTerms", &model.licence),
        std::pair("octurn:InventoryNumber", &model.inventory_number)}) {
    if (!text->empty()) {
      xml << "<metadata name=\"" << name << "\">" << escaped(to_one_line(*text)) << "</metadata>";
    }
  }
}

void write_model(XmlStream& xml, const MeshModel& model) {
  const std::span<const Rgb> colours = model.colours;
  const VertexTable table(model.facets);
  expect_colours_of(table, colours);
  xml << R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02")"
      << (colours.empty() ? "" : materials) << own_namespace << ">";
  write_metadata(xml, model);
  xml << R"(<metadata name="Application">Octurn</metadata><resources>)";
  if (!colours.empty()) {
    write_colours(xml, colours);
  }
  xml << R"(<object id="1" type="model" name=")" << escaped(model.name)
      << (colours.empty() ? R"("><mesh><vertices>)" : R"(" pid="2" pindex="0"><mesh><vertices>)");
  for (const Vertex& vertex : table.vertices()) {
    (xml << "<vertex x=\"").number(vertex[0]);
    (xml << "\" y=\"").number(vertex[1]);
    (xml << "\" z=\"").number(vertex[2]) << "\"/>";
  }
  xml << "</vertices><triangles>";
  write_triangles(xml, model.facets, table, colours);
  xml << R"(</triangles></mesh></object></resources><build><item objectid="1"/></build></model>)"
      << "\n";
  xml.flush();
}

}  // namespace

void write_3mf(const MeshModel& model, const std::filesystem::path& target) {
  const std::string& thumbnail = model.thumbnail;
  ZipWriter zip(target);
  zip.begin("[Content_Types].xml", ZipMethod::deflated);
  zip.write(content_types);
  zip.begin("_rels/.rels", ZipMethod::deflated);
  zip.write(std::string(relationships_begin) +
            std::string(thumbnail.empty() ? "" : thumbnail_relationship) + "</Relationships>\n");
  if (!thumbnail.empty()) {
    zip.begin("Metadata/thumbnail.png", ZipMethod::stored);
    zip.write(thumbnail);
  }
  zip.begin("3D/3dmodel.model", ZipMethod::deflated);
  XmlStream xml(zip);
  write_model(xml, model);
  zip.commit();
}

}  // namespace octurn
