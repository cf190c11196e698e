// What the API answers to who asks for a model.

#include <nlohmann/json.hpp>
#include <utility>

#include "http/api.hpp"
#include "http/entity_tags.hpp"
#include "http/file_response.hpp"
#include "log.hpp"
#include "octurn/json_object.hpp"
#include "scan/model_stream.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// What a query says, "leaf_size_mm=0.5&level=7": numbers by name.
json numbers_from(std::string_view query) {
  json numbers = json::object();
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(part.size() + 1, query.size()));
    const std::size_t equals = part.find('=');
    const std::string name(part.substr(0, equals));
    const json value = equals == std::string_view::npos
                           ? json()
                           : json::parse(part.substr(equals + 1), nullptr, false);
    if (!value.is_number() || !numbers.emplace(name, value).second) {
      throw Error("bad-settings", "the query must give each setting once, as a number",
                  "Such as ?leaf_size_mm=0.5&level=7.");
    }
  }
  return numbers;
}

std::string file_name(const Job& job) { return (job.name.empty() ? "Scan" : job.name) + ".stl"; }

}  // namespace

Response Api::newest_model(const Request& request, std::string_view /*id*/) {
  const std::optional<Job> newest = store_.newest_finished();
  if (!newest) {
    throw Error("no-model", "no scan is finished yet", "Start a scan and wait for its end.");
  }
  return file_response(request, store_.model_file(newest->id), "model/stl", "Scan.stl");
}

Response Api::model(const Request& request, std::string_view id) {
  const Job job = find(id);
  if (!request.query.empty()) {
    return made_model(request, job);
  }
  if (job.state != JobState::finished) {
    throw Error("no-model", "this scan is " + std::string(name_of(job.state)) + ": it has no model",
                "Only a finished scan has one.");
  }
  return file_response(request, store_.model_file(id), "model/stl", file_name(job));
}

Response Api::made_model(const Request& request, const Job& job) {
  json numbers = numbers_from(request.query);
  std::optional<int> level;
  if (const auto given = numbers.find("level"); given != numbers.end()) {
    level = JsonObject(numbers, "bad-settings", "").whole_number("level", 0, max_levels);
    numbers.erase(given);
  }
  for (const auto& [name, value] : numbers.items()) {
    if (name != "leaf_size_mm") {
      throw Error("bad-settings", "the query has \"" + name + "\"",
                  "It takes leaf_size_mm and level.");
    }
  }
  ReconstructOptions options =
      reconstruct_options(settings_from(numbers, job.settings), patient_.config.limits);
  options.level = level;
  if (job.state != JobState::running && job.snapshots_done == 0) {
    throw Error("no-model", "this scan has no snapshots", "Start a new scan.");
  }
  auto leave = scanner_.leave_to_reconstruct();
  if (!leave) {
    throw Error("busy", "a scan is running, or another model is being made", "Wait for its end.");
  }
  auto model = std::make_unique<ModelStream>(store_.folder(job.id), options, std::move(leave));
  const std::uint64_t bytes = model->bytes();
  ByteStream stream{.length = bytes, .stop = model->stop()};
  stream.make = std::packaged_task<void(const ByteSink&)>(
      [made = std::move(model), id = job.id](const ByteSink& sink) {
        try {
          made->send(sink);
        } catch (const std::exception& error) {
          log::error("http", "model of scan " + id + ": " + error.what());
        }
      });
  return {.headers = {{"Content-Type", "model/stl"},
                      {"Content-Disposition", attachment(file_name(job))},
                      {"Accept-Ranges", "none"},
                      {"Cache-Control", "no-store"}},
          .body = std::move(stream)};
}

Response Api::surface_so_far(const Request& request, std::string_view id) {
  find(id);  // or there is no such scan
  const auto preview = scanner_.preview();
  if (preview->id != id || preview->snapshots == 0) {
    throw Error("no-preview", "there is nothing of this scan to show",
                "Only the latest scan has a preview, from its first snapshot on.");
  }
  const std::string tag = '"' + preview->id + '-' + std::to_string(preview->snapshots) + '"';
  Headers headers{{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (const auto known = request.header("If-None-Match"); known && matches_weakly(*known, tag)) {
    return {.status = 304, .headers = std::move(headers)};
  }
  headers.emplace_back("Content-Type", "model/stl");
  return {.headers = std::move(headers), .body = preview->stl};
}

}  // namespace octurn
