#include "http/handlers/settings.hpp"

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "http/file_response.hpp"
#include "http/json_body.hpp"
#include "http/password_file.hpp"
#include "log.hpp"
#include "mesh/mesh_formats.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "version.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr const char* backup_format = "octurn-settings";
constexpr int backup_version = 1;

/// The source of the page's password: "page" or "octurn.json"; "everybody" if there is none.
std::string_view password_state(const App& app) {
  const Config config = app.settings.config();
  return std::filesystem::exists(own_password_file(config)) ? "page"
         : config.http.password_file.empty()                ? "everybody"
                                                            : "octurn.json";
}

/// The settings of a backup. @throws Error "bad-settings"
json settings_in(const json& backup) {
  JsonObject keys(backup, ErrorCode::bad_settings, "");
  const auto format = keys.text("format");
  if (format != backup_format) {
    throw Error(ErrorCode::bad_settings, "this is no backup of Octurn's settings",
                "Choose a file octurn-settings-....json that this page has given.");
  }
  keys.whole_number("version", backup_version, backup_version);
  keys.text("program");
  json settings = keys.at("settings").json();
  keys.refuse_unread();
  return settings;
}

/// The formats in which a model can be had, as extensions without the dot.
json model_formats() {
  json names = json::array({"stl"});
  for (const MeshFormat& format : mesh_formats()) {
    names.push_back(format.extension.substr(1));
  }
  return names;
}

/// A key without its hash.
json to_json(const AccessKey& key) {
  return {{"id", key.id},
          {"name", key.name},
          {"access", to_string(key.access)},
          {"created", key.created}};
}

}  // namespace

Response send_settings(App& app) {
  const Config config = app.settings.config();
  ScanSettings defaults = app.scanner.calibration().in_force(config.scan);
  const std::vector<Field> scan = fields(defaults);
  return json_response({{"defaults", to_json(scan)},
                        {"schema", to_schema(scan)},
                        {"settings", to_json(config)},
                        {"preset", to_json(app.settings.preset())},
                        {"stored", app.settings.stored()},
                        {"settings_schema", config_schema()},
                        {"restart_needed", app.settings.restart_needed()},
                        {"trouble", app.settings.trouble()},
                        {"password", password_state(app)},
                        {"model_formats", model_formats()}});
}

Response change_settings(App& app, const Request& request) {
  app.settings.change(parse_body(request));
  log::info("settings", "changed by the page");
  return send_settings(app);
}

Response send_backup(App& app) {
  const auto time = std::chrono::system_clock::now();
  const json backup{{"format", backup_format},
                    {"version", backup_version},
                    {"program", version()},
                    {"settings", app.settings.stored()}};
  const std::string name = "octurn-settings-" + utc_text(time, "%Y%m%d-%H%M%S") + ".json";
  return {.headers = {{"Content-Type", "application/json"},
                      {"Content-Disposition", attachment(name)},
                      {"Cache-Control", "no-store"}},
          .body = backup.dump(2) + "\n"};
}

Response restore_backup(App& app, const Request& request) {
  app.settings.replace(settings_in(parse_body(request)));
  log::info("settings", "restored from a backup");
  return send_settings(app);
}

Response set_page_password(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const std::optional<std::string> hash = keys.text("hash");
  const auto password = hash ? std::optional<JsonValue>() : keys.at("password");
  keys.refuse_unread();
  const std::filesystem::path file = own_password_file(app.settings.config());
  if (hash) {
    write_password_hash(file, *hash);
  } else if (password->json().is_null()) {
    std::filesystem::remove(file);
  } else {
    write_password_file(file, password->text());
  }
  log::info("settings", "the page's password was changed");
  return send_settings(app);
}

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
