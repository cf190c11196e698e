#include "http/handlers/models.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <future>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <semaphore>
#include <system_error>
#include <utility>
#include <vector>

#include "build/colour_model.hpp"
#include "http/file_response.hpp"
#include "http/handlers/builds.hpp"
#include "http/place.hpp"
#include "http/scan_view.hpp"
#include "mesh/coarse_mesh.hpp"
#include "mesh/mesh_formats.hpp"
#include "mesh/thumbnail.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "run/command_slot.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A decimal number; nothing if the text is anything else, or beyond the range of a double.
std::optional<json> to_number(std::string_view text) {
  const char* const end = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto read = std::from_chars(text.data(), end, whole);
      read.ec == std::errc() && read.ptr == end) {
    return whole;
  }
  double number = 0;
  const auto read = std::from_chars(text.data(), end, number);
  const bool is_number = read.ec == std::errc() && read.ptr == end && std::isfinite(number);
  return is_number ? std::optional<json>(number) : std::nullopt;
}

/// Parses query parameters as numbers. @throws Error "bad-settings"
json to_numbers(const Headers& parameters) {
  json numbers = json::object();
  for (const auto& [name, text] : parameters) {
    const std::optional<json> value = to_number(text);
    if (!value || !numbers.emplace(name, *value).second) {
      throw Error(ErrorCode::bad_settings, "the query must give each setting once, as a number",
                  "Such as ?leaf_size_mm=0.5&level=7.");
    }
  }
  return numbers;
}

// Of requests that wait for the worker: for their own model, or for some seconds until another one
// is made.
std::counting_semaphore<> worker_places{2};

/// @throws Error "busy", "too-many"
std::unique_ptr<ModelStream> stream_model(App& app, const Job& job,
                                          const ReconstructOptions& options) {
  const Place place(&worker_places, "others are waiting for a model");
  auto model = app.scanner.stream_model(job.id, options);
  if (!model) {
    throw Error(ErrorCode::busy, "a scan is running, or another model is being made",
                "Wait for its end.");
  }
  return model;
}

/// Builds a model from the snapshots and streams it.
Response make_model(App& app, const Request& request, const Job& job) {
  json numbers = to_numbers(request.parameters);
  std::optional<int> level;
  if (const auto given = numbers.find("level"); given != numbers.end()) {
    level = JsonObject(numbers, ErrorCode::bad_settings, "").whole_number("level", 0, max_levels);
    numbers.erase(given);
  }
  for (const auto& [name, value] : numbers.items()) {
    if (name != "leaf_size_mm") {
      throw Error(ErrorCode::bad_settings, "the query has \"" + name + "\"",
                  "It takes leaf_size_mm and level.");
    }
  }
  ReconstructOptions options =
      reconstruct_options(settings_from(numbers, job.settings), app.settings.config().limits);
  options.level = level;
  if (job.state != JobState::running && job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  auto model = stream_model(app, job, options);
  const std::uint64_t bytes = model->bytes();
  ByteStream stream{.length = bytes, .stop = model->stop()};
  stream.make = std::packaged_task<void(const ByteSink&)>(
      [made = std::move(model)](const ByteSink& sink) { made->send(sink); });
  return {.headers = {{"Content-Type", "model/stl"},
                      {"Content-Disposition", attachment(download_name(job, ".stl"))},
                      {"Accept-Ranges", "none"},
                      {"Cache-Control", "no-store"}},
          .body = std::move(stream)};
}

}  // namespace

void refuse_colours(const Request& request) {
  if (std::ranges::find(request.parameters, "colour", &Headers::value_type::first) !=
      request.parameters.end()) {
    throw Error(ErrorCode::bad_settings, "an STL has no colours",
                "Ask for " + mesh_file_names("Scan") + ".");
  }
}

std::string download_name(const Job& job, std::string_view ending) {
  return std::string(job.label.name.empty() ? "Scan" : job.label.name).append(ending);
}

namespace {

/// The path of a scan's STL. @throws Error "no-model"
std::filesystem::path find_model(const App& app, const Job& job) {
  if (chosen_model(job) == nullptr) {
    throw Error(ErrorCode::no_model,
                "this scan is " + std::string(to_string(job.state)) + ": it has no model",
                "Only a finished scan has one.");
  }
  return app.store.model_file(job.id);
}

}  // namespace

Response send_newest_model(App& app, const Request& request) {
  refuse_colours(request);
  const std::optional<Job> newest = app.store.newest_finished();
  if (!newest) {
    throw Error(ErrorCode::no_model, "no scan is finished yet",
                "Start a scan and wait for its end.");
  }
  return file_response(request, app.store.model_file(newest->id), "model/stl", "Scan.stl");
}

Response send_model(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  refuse_colours(request);
  if (!request.parameters.empty()) {
    return make_model(app, request, job);
  }
  return file_response(request, find_model(app, job), "model/stl", download_name(job, ".stl"));
}

Response send_preview(App& app, const Request& request, std::string_view id) {
  find_scan(app, id);  // throws if there is no such scan
  const auto preview = app.scanner.mesh_preview();
  if (preview->id != id || preview->snapshots == 0) {
    throw Error(ErrorCode::no_preview, "there is nothing of this scan to show",
                "Only the latest scan has a preview, from its first snapshot on.");
  }
  const std::string tag = '"' + preview->id + '-' + std::to_string(preview->snapshots) + '"';
  Headers headers{{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (client_has(request, tag)) {
    return {.status = 304, .headers = std::move(headers)};
  }
  headers.emplace_back("Content-Type", "model/stl");
  return {.headers = std::move(headers), .body = preview->stl};
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_coarse_facets = 3000;  // 150 kB; the first view with three.js: 400 kB
constexpr std::size_t max_thumbnail_bytes = std::size_t{1} << 20U;

// Held while a cached file is checked and made: memory suffices for one at a time.
std::mutex making;
// Held while colours are checked and made, so that requests for several formats of a model make
// them once.
std::mutex colouring;
// Of requests that hold these or wait for them: a browser has six connections, and the server 28.
std::counting_semaphore<> making_places{6};

Place place_for_making() { return {&making_places, "files of models are being made for others"}; }

/// The modification time of a file; the minimum if there is no file.
fs::file_time_type written(const fs::path& file) {
  std::error_code none;
  const auto time = fs::last_write_time(file, none);
  return none ? fs::file_time_type::min() : time;
}

bool is_fresh(const fs::path& file, fs::file_time_type source) {
  const fs::file_time_type made = written(file);
  return made != fs::file_time_type::min() && made >= source;
}

/// Makes a file if it is missing, or older than its source. Runs on a new thread, as the HTTP
/// server's threads have small stacks.
/// @throws Error "too-many"  if it has to be made, and others are
void keep_fresh(const fs::path& file, fs::file_time_type source,
                const std::function<void()>& make) {
  if (is_fresh(file, source)) {
    return;
  }
  const Place place = place_for_making();
  const std::lock_guard lock(making);
  if (!is_fresh(file, source)) {  // another request may have made it meanwhile
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

/// Sends a simplified model for a fast first view.
Response send_coarse(const Request& request, const fs::path& model) {
  const fs::path file = model.parent_path() / "coarse.stl";
  keep_fresh(file, written(model),
             [&] { write_file(file, stl_text(coarse_mesh(FacetFile(model), max_coarse_facets))); });
  return file_response(request, file, "model/stl", "coarse.stl");
}

/// The part of a file's name that tells its colours.
std::string suffix_of(std::optional<Colours> paint) {
  return !paint ? "" : *paint == Colours::views ? "-views" : "-colour";
}

/// The path of a model in another format. It is made if it is missing, or older than the model, the
/// scan's name or the colours.
fs::path fresh_mesh(const App& app, const Job& job, const fs::path& model, const MeshFormat& format,
                    std::optional<Colours> paint = {}) {
  fs::path file = model.parent_path() / ("Scan" + suffix_of(paint));
  file += format.extension;
  fs::file_time_type source = written(model);
  for (const LabelText& text : label_texts()) {
    if (text.is_in_model) {
      source = std::max(source, written(app.store.folder(job.id) / text.file));
    }
  }
  source = paint ? std::max(source, written(colours_file(model, *paint))) : source;
  const fs::path thumbnail = format.has_thumbnail ? fresh_thumbnail(model) : fs::path();
  keep_fresh(file, source, [&] {
    const FacetFile facets(model);
    const auto png = read_regular_file(thumbnail, max_thumbnail_bytes);  // nothing without a path
    const std::vector<Rgb> colours = paint ? read_colours(model, *paint) : std::vector<Rgb>();
    format.write({.facets = facets,
                  .name = download_name(job, ""),
                  .inventory_number = job.label.inventory_number,
                  .author = job.label.author,
                  .licence = job.label.licence,
                  .thumbnail = png.value_or(""),
                  .colours = colours},
                 file);
  });
  return file;
}

/// Parses a query that is empty or has `colour`. @return nothing: clay @throws Error "bad-settings"
std::optional<Colours> wanted_paint(const Request& request) {
  if (request.parameters.empty()) {
    return std::nullopt;
  }
  const auto& [name, value] = request.parameters.front();
  const bool is_known = value == "true" || value == "false" || value == "views";
  if (request.parameters.size() > 1 || name != "colour" || !is_known) {
    throw Error(ErrorCode::bad_settings, "the query of this format takes colour alone",
                "It is true, false or views: ?colour=true");
  }
  return value == "false"   ? std::nullopt
         : value == "views" ? std::optional(Colours::views)
                            : std::optional(Colours::pictures);
}

/// Has the worker make the colours of a model if they are missing or outdated. The pictures are
/// many and large, so that an occupied worker refuses.
/// @param build  number of the model's build
/// @throws Error "bad-settings"  if the scan does not have what they are made of, "busy",
///                               "too-many"
void keep_colours(App& app, const Job& job, const fs::path& model, int build, Colours shown) {
  if (shown == Colours::pictures && !job.builds.have_colours) {
    throw Error(ErrorCode::bad_settings, "this scan has no pictures in colour",
                "Only a scan by laser line has them, if its camera sees colours.");
  }
  const fs::path file = colours_file(model, shown);
  if (is_fresh(file, written(model))) {
    return;
  }
  const Place place = place_for_making();
  const std::lock_guard lock(colouring);
  if (!is_fresh(file, written(model)) && !app.scanner.colour_model(job, build, shown)) {
    throw Error(ErrorCode::busy, "a scan is running, or another model is being made",
                "Wait for its end.");
  }
}

/// Sends a model in the format of the request path's extension.
/// @param build   number of the model's build
/// @param suffix  of the file name under which a browser saves the model, before the extension
Response send_in_format(App& app, const Request& request, const Job& job, const fs::path& model,
                        int build, std::string suffix) {
  const std::string extension = fs::path(request.path).extension().string();
  const MeshFormat* const format = find_mesh_format(extension);
  if (format == nullptr) {
    throw Error(ErrorCode::not_found, "there is no " + fs::path(request.path).filename().string(),
                "Ask for Scan.stl, " + mesh_file_names("Scan") + ".");
  }
  const std::optional<Colours> paint = wanted_paint(request);
  if (paint) {
    keep_colours(app, job, model, build, *paint);
  }
  suffix += suffix_of(paint);
  return file_response(request, fresh_mesh(app, job, model, *format, paint),
                       std::string(format->media_type), download_name(job, suffix + extension));
}

}  // namespace

fs::path model_in_format(const App& app, const Job& job, const std::string& extension) {
  fs::path model = find_model(app, job);
  const MeshFormat* const format = find_mesh_format(extension);
  return format != nullptr ? fresh_mesh(app, job, model, *format) : model;
}

Response send_mesh(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  const int build = find_build(job, job.builds.chosen) != nullptr ? job.builds.chosen : 0;
  return send_in_format(app, request, job, find_model(app, job), build, "");
}

Response send_build_mesh(App& app, const Request& request, std::string_view id,
                         std::string_view build) {
  const fs::path model = find_build_model(app, id, build);  // checks that `build` is a number
  return send_in_format(app, request, find_scan(app, id), model, std::stoi(std::string(build)),
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
