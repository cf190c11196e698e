#include "http/handlers/outgoing.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "http/handlers/models.hpp"
#include "http/json_body.hpp"
#include "http/scan_view.hpp"
#include "log.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json webhook_json(const App& app, const Webhook& webhook) {
  json body{{"id", webhook.id},
            {"address", to_origin(webhook.url)},
            {"events", webhook.events},
            {"last", nullptr}};
  if (const auto state = app.webhooks->state(webhook.id)) {
    body["last"] = {{"outcome", to_string(state->outcome)},
                    {"event", state->event},
                    {"time", state->time.empty() ? json(nullptr) : json(state->time)},
                    {"trouble", state->trouble}};
  }
  return body;
}

json to_json(const Printer& printer) {
  return {{"id", printer.id},
          {"name", printer.name},
          {"kind", to_string(printer.kind)},
          {"address", to_origin(printer.url)},
          {"has_key", !printer.key.empty()},
          {"fingerprint", printer.fingerprint}};
}

json to_json(const PrinterUpload& upload) {
  return {{"scan", upload.scan},         {"printer", upload.printer},
          {"file", upload.file},         {"state", to_string(upload.state)},
          {"progress", upload.progress}, {"detail", upload.trouble.detail},
          {"hint", upload.trouble.hint}, {"fingerprint", upload.trouble.fingerprint}};
}

Response created(const json& body, const std::string& place) {
  Response response = json_response(body, 201);
  response.headers.emplace_back("Location", place + body.at("id").get<std::string>());
  return response;
}

[[noreturn]] void throw_not_found(const std::string& what, const std::string& list) {
  throw Error(ErrorCode::not_found, "there is no " + what, "GET " + list + " lists them.");
}

/// The extension of the format that a body asks for.
std::string format_in(JsonObject& object) {
  const auto format = object.value("format");
  if (!format) {
    return ".stl";
  }
  if (format->text() != "stl" && format->text() != "3mf") {
    format->refuse(R"("stl" or "3mf")");
  }
  return "." + format->text();
}

}  // namespace

Response list_webhooks(App& app) {
  json all = json::array();
  for (const Webhook& webhook : app.addresses.webhooks()) {
    all.push_back(webhook_json(app, webhook));
  }
  return json_response({{"webhooks", std::move(all)}, {"events", webhook_events}});
}

Response add_webhook(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject object(body, ErrorCode::bad_settings, "");
  Webhook webhook = webhook_from(object);
  object.refuse_unread();
  webhook = app.addresses.add(std::move(webhook));
  log::info("outgoing", "a webhook was added");
  return created(webhook_json(app, webhook), "/api/v1/webhooks/");
}

Response remove_webhook(App& app, std::string_view id) {
  if (!app.addresses.remove_webhook(id)) {
    throw_not_found("webhook " + std::string(id), "/api/v1/webhooks");
  }
  log::info("outgoing", "a webhook was removed");
  return {.status = 204};
}

Response test_webhook(App& app, std::string_view id) {
  const auto webhook = app.addresses.find_webhook(id);
  if (!webhook) {
    throw_not_found("webhook " + std::string(id), "/api/v1/webhooks");
  }
  app.webhooks->queue(webhook->id, make_test_event());
  return json_response(webhook_json(app, *webhook), 202);
}

Response list_printers(App& app) {
  json all = json::array();
  for (const Printer& printer : app.addresses.printers()) {
    all.push_back(to_json(printer));
  }
  return json_response({{"printers", std::move(all)}});
}

Response add_printer(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject object(body, ErrorCode::bad_settings, "");
  Printer printer = printer_from(object);
  object.refuse_unread();
  printer = app.addresses.add(std::move(printer));
  log::info("outgoing", "a printer was added");
  return created(to_json(printer), "/api/v1/printers/");
}

Response trust_printer(App& app, const Request& request, std::string_view id) {
  const json body = parse_body(request);
  JsonObject object(body, ErrorCode::bad_settings, "");
  object.at("fingerprint");
  const std::string fingerprint = fingerprint_from(object);
  object.refuse_unread();
  const auto printer = app.addresses.trust(id, fingerprint);
  if (!printer) {
    throw_not_found("printer " + std::string(id), "/api/v1/printers");
  }
  log::info("outgoing", fingerprint.empty() ? "no certificate of a printer is trusted any more"
                                            : "a printer's certificate is trusted");
  return json_response(to_json(*printer));
}

Response remove_printer(App& app, std::string_view id) {
  if (!app.addresses.remove_printer(id)) {
    throw_not_found("printer " + std::string(id), "/api/v1/printers");
  }
  log::info("outgoing", "a printer was removed");
  return {.status = 204};
}

Response send_to_printer(App& app, const Request& request, std::string_view id) {
  const json body = parse_body(request);
  JsonObject object(body, ErrorCode::bad_settings, "");
  const JsonValue wanted = object.at("printer");
  const std::string extension = format_in(object);
  object.refuse_unread();
  const auto printer = app.addresses.find_printer(wanted.text());
  if (!printer) {
    wanted.refuse("the id or the name of a printer that the settings have");
  }
  const Job job = find_scan(app, id);
  const std::filesystem::path file = model_in_format(app, job, extension);
  // A printer keeps one file of each name, so the file of an unnamed scan is named by its id.
  const std::string name =
      job.label.name.empty() ? "Scan-" + job.id + extension : download_name(job, extension);
  const auto begun = app.uploads.start(job.id, *printer, file, name);
  if (!begun) {
    throw Error(ErrorCode::busy, "another model is being sent to a printer",
                "Wait for its end, or cancel it.");
  }
  Response response = json_response(to_json(*begun), 202);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job.id + "/send");
  return response;
}

Response send_upload(App& app, std::string_view id) {
  const auto last = app.uploads.last(id);
  if (!last) {
    throw Error(ErrorCode::not_found, "this scan was not sent to a printer, or others were since",
                "POST to this address sends it.");
  }
  return json_response(to_json(*last));
}

Response cancel_upload(App& app, std::string_view id) {
  if (!app.uploads.cancel(id)) {
    throw Error(ErrorCode::not_running, "this scan is not being sent to a printer",
                "Only an upload that is still running can be cancelled.");
  }
  return {.status = 204};
}

}  // namespace octurn
