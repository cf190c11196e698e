#include "http/handlers/formats.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <system_error>

#include "http/file_response.hpp"
#include "http/handlers/builds.hpp"
#include "http/handlers/models.hpp"
#include "http/scan_view.hpp"
#include "mesh/coarse_mesh.hpp"
#include "mesh/mesh_formats.hpp"
#include "mesh/thumbnail.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_coarse_facets = 3000;  // 150 kB: with three.js, a first sight of 400 kB
constexpr std::size_t max_thumbnail_bytes = std::size_t{1} << 20U;

// Memory is for one at a time. Held while a file is looked at and made.
std::mutex making;

/// When a file was written; long ago where there is none.
fs::file_time_type written(const fs::path& file) {
  std::error_code none;
  const auto time = fs::last_write_time(file, none);
  return none ? fs::file_time_type::min() : time;
}

/// Makes a file unless it is there, and not older than what it is made of. On a thread of its own:
/// those of the HTTP server have little stack.
void keep_fresh(const fs::path& file, fs::file_time_type source,
                const std::function<void()>& make) {
  const std::lock_guard lock(making);
  if (const auto made = written(file); made == fs::file_time_type::min() || made < source) {
    std::async(std::launch::async, make).get();
  }
}

fs::path fresh_thumbnail(const fs::path& model) {
  fs::path file = model.parent_path() / "thumbnail.png";
  keep_fresh(file, written(model), [&] {
    const std::vector<std::byte> png = draw_thumbnail(FacetFile(model));
    write_file(file, {reinterpret_cast<const char*>(png.data()), png.size()});
  });
  return file;
}

/// A model for a first sight of it.
Response send_coarse(const Request& request, const fs::path& model) {
  const fs::path file = model.parent_path() / "coarse.stl";
  keep_fresh(file, written(model),
             [&] { write_file(file, stl_text(coarse_mesh(FacetFile(model), max_coarse_facets))); });
  return file_response(request, file, "model/stl", "coarse.stl");
}

/// @param thumbnail  of the model, for a format that has one in it
void write_mesh(MeshFormat format, const fs::path& model, const fs::path& thumbnail,
                const std::string& name, const fs::path& file) {
  const FacetFile facets(model);
  switch (format) {
    case MeshFormat::ply:
      write_ply(facets, file);
      break;
    case MeshFormat::glb:
      write_glb(facets, name, file);
      break;
    case MeshFormat::threemf:
      write_3mf(facets, name, read_regular_file(thumbnail, max_thumbnail_bytes).value_or(""), file);
      break;
  }
}

/// The file of a model in another format, made if it is not there.
fs::path fresh_mesh(const App& app, const Job& job, const fs::path& model, MeshFormat format,
                    const std::string& extension) {
  fs::path file = model.parent_path() / ("Scan" + extension);
  const auto source = std::max(written(model), written(app.store.folder(job.id) / "name.txt"));
  const fs::path thumbnail = format == MeshFormat::threemf ? fresh_thumbnail(model) : fs::path();
  keep_fresh(file, source,
             [&] { write_mesh(format, model, thumbnail, download_name(job, ""), file); });
  return file;
}

/// A model in the format that its path ends with.
/// @param suffix  of the name under which a browser saves it, before the extension
Response send_in_format(App& app, const Request& request, const Job& job, const fs::path& model,
                        const std::string& suffix) {
  const std::string extension = fs::path(request.path).extension().string();
  const MeshFormat format = mesh_format_of(extension).value();  // as its route has it
  return file_response(request, fresh_mesh(app, job, model, format, extension),
                       std::string(media_type(format)), download_name(job, suffix + extension));
}

}  // namespace

fs::path model_in_format(const App& app, const Job& job, const std::string& extension) {
  fs::path model = find_model(app, job);
  const auto format = mesh_format_of(extension);
  return format ? fresh_mesh(app, job, model, *format, extension) : model;
}

Response send_mesh(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  return send_in_format(app, request, job, find_model(app, job), "");
}

Response send_build_mesh(App& app, const Request& request, std::string_view id,
                         std::string_view build) {
  return send_in_format(app, request, find_scan(app, id), find_build_model(app, id, build),
                        "-" + std::string(build));
}

Response send_thumbnail(App& app, const Request& request, std::string_view id) {
  const fs::path model = find_model(app, find_scan(app, id));
  return file_response(request, fresh_thumbnail(model), "image/png", "thumbnail.png");
}

Response send_coarse_model(App& app, const Request& request, std::string_view id) {
  return send_coarse(request, find_model(app, find_scan(app, id)));
}

Response send_coarse_build(App& app, const Request& request, std::string_view id,
                           std::string_view build) {
  return send_coarse(request, find_build_model(app, id, build));
}

}  // namespace octurn
