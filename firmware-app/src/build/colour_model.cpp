#include "build/colour_model.hpp"

#include <cmath>
#include <span>
#include <string>

#include "mesh/model_colours.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/units.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

// Peak memory: vertex table, triangles, normals, vertices in the camera's frame, and colour sums,
// at half a vertex per triangle.
constexpr std::uint64_t bytes_per_triangle = 60;
// A depth image, a decoded picture, and the bytes of its file.
constexpr std::uint64_t bytes_per_pixel = 12;
constexpr std::uint64_t max_colours_bytes = std::uint64_t{128} << 20U;

void expect_memory(const FacetFile& facets, const Intrinsics& lens, std::size_t memory_limit) {
  const auto pixels = static_cast<std::uint64_t>(lens.width) * static_cast<unsigned>(lens.height);
  const std::uint64_t needed = bytes_per_triangle * facets.count() + bytes_per_pixel * pixels;
  if (memory_limit > 0 && needed > memory_limit) {
    const double needed_mb = std::ceil(mb_from_bytes(static_cast<double>(needed)));
    const double limit_mb = mb_from_bytes(static_cast<double>(memory_limit));
    throw Error(ErrorCode::memory_limit,
                "the colours of this model take about " + std::to_string(std::lround(needed_mb)) +
                    " MB, of " + std::to_string(std::lround(limit_mb)) + " MB that are allowed",
                "Build the model with larger leaves, or download it without colours.",
                {{"limit_mb", limit_mb}, {"needed_mb", needed_mb}});
  }
}

void expect_depth(const Scan& scan) {
  if (scan.laser) {
    throw Error(ErrorCode::bad_settings, "the scan has no depth images to count",
                "Only a scan by a depth sensor has them.");
  }
}

}  // namespace

std::filesystem::path colours_file(const std::filesystem::path& model, Colours shown) {
  return model.parent_path() / (shown == Colours::views ? "views.rgb" : "colours.rgb");
}

namespace {

/// Refuses a scan that is not by laser line. @throws Error "bad-settings"
void expect_pictures(const Scan& scan) {
  if (!scan.laser) {
    throw Error(ErrorCode::bad_settings, "the scan has no pictures, and so no colours",
                "Only a scan by laser line has them.");
  }
}

}  // namespace

void colour_model(const std::filesystem::path& model, const ModelScan& of, Colours shown,
                  std::size_t memory_limit, const std::stop_token& stop) {
  const bool are_views = shown == Colours::views;
  are_views ? expect_depth(of.scan) : expect_pictures(of.scan);
  const FacetFile facets(model);
  expect_memory(facets, of.scan.intrinsics, memory_limit);
  const std::vector<Rgb> colours =
      are_views ? view_colours(facets, readable_snapshots(of.folder, of.scan, stop), of.edits, stop)
                : model_colours(facets, of.folder, of.scan, of.edits, stop);
  const auto bytes = std::as_bytes(std::span(colours));
  write_file(colours_file(model, shown),
             {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::vector<Rgb> read_colours(const std::filesystem::path& model, Colours shown) {
  const auto text = read_regular_file(colours_file(model, shown), max_colours_bytes);
  if (!text || text->size() % sizeof(Rgb) != 0) {
    throw Error(ErrorCode::read_failed, "the colours of this model are missing, or not whole",
                "Download it again.");
  }
  std::vector<Rgb> colours(text->size() / sizeof(Rgb));
  text->copy(reinterpret_cast<char*>(colours.data()), text->size());
  return colours;
}

}  // namespace octurn
