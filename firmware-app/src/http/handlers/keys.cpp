#include "http/handlers/keys.hpp"

#include <chrono>
#include <nlohmann/json.hpp>

#include "http/json_body.hpp"
#include "log.hpp"
#include "octurn/json_object.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A key without its hash.
json to_json(const AccessKey& key) {
  return {{"id", key.id},
          {"name", key.name},
          {"access", to_string(key.access)},
          {"created", key.created}};
}

}  // namespace

Response list_keys(App& app) {
  json all = json::array();
  for (const AccessKey& key : app.keys.all()) {
    all.push_back(to_json(key));
  }
  return json_response({{"keys", std::move(all)}});
}

Response make_key(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject object(body, ErrorCode::bad_settings, "");
  const std::string name = name_in(object);
  const JsonValue access = object.at("access");
  const auto known = to_key_access(access.text());
  if (!known) {
    access.refuse(R"("read" or "full")");
  }
  object.refuse_unread();
  const auto made = app.keys.add(name, *known, std::chrono::system_clock::now());
  json answer = to_json(made.kept);
  answer["key"] = made.key;
  log::info("http", "a key was made");
  return {.status = 201,
          .headers = {{"Content-Type", "application/json"},
                      {"Cache-Control", "no-store"},
                      {"Location", "/api/v1/keys/" + answer["id"].get<std::string>()}},
          .body = answer.dump() + "\n"};
}

Response revoke_key(App& app, std::string_view id) {
  if (!app.keys.revoke(id)) {
    throw Error(ErrorCode::not_found, "there is no key " + std::string(id),
                "GET /api/v1/keys lists them.");
  }
  log::info("http", "a key was revoked");
  return {.status = 204};
}

}  // namespace octurn
