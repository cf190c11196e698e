#include "http/handlers/models.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <semaphore>
#include <string_view>
#include <system_error>
#include <utility>

#include "http/entity_tags.hpp"
#include "http/file_response.hpp"
#include "http/place.hpp"
#include "http/scan_view.hpp"
#include "mesh/mesh_formats.hpp"
#include "octurn/json_object.hpp"
#include "run/model_pipe.hpp"

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

std::filesystem::path find_model(const App& app, const Job& job) {
  if (chosen_model(job) == nullptr) {
    throw Error(ErrorCode::no_model,
                "this scan is " + std::string(to_string(job.state)) + ": it has no model",
                "Only a finished scan has one.");
  }
  return app.store.model_file(job.id);
}

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

}  // namespace octurn
