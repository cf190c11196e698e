#include "commands/coloured_model.hpp"

#include <string>
#include <system_error>

#include "mesh/model_colours.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

const MeshFormat& to_format(const std::filesystem::path& file) {
  const MeshFormat* const format = find_mesh_format(file.extension().string());
  if (format == nullptr) {
    throw Error(
        ErrorCode::bad_settings,
        file.string() + ": a model with colours is a file that ends with " + mesh_file_names(""),
        "An STL has no colours.");
  }
  return *format;
}

}  // namespace

ColouredModel::ColouredModel(const std::filesystem::path& file, const Scan& scan)
    : file_(std::filesystem::absolute(file)),
      stl_(temporary_name(file_.string() + ".stl", 0)),
      format_(to_format(file)) {
  if (!scan.laser) {
    throw Error(ErrorCode::scan_malformed, "the scan has no pictures, and so no colours",
                "Only a scan by laser line has them.");
  }
}

ColouredModel::~ColouredModel() {
  std::error_code ignored;
  std::filesystem::remove(stl_, ignored);
}

void ColouredModel::write(const std::filesystem::path& folder, const Scan& scan,
                          const std::stop_token& stop) const {
  const FacetFile facets(stl_);
  const std::vector<Rgb> colours = model_colours(facets, folder, scan, stop);
  format_.write({.facets = facets, .name = file_.stem().string(), .colours = colours}, file_);
}

}  // namespace octurn
