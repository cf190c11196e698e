#include "http/api.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/builds.hpp"
#include "http/handlers/calibration.hpp"
#include "http/handlers/events.hpp"
#include "http/handlers/models.hpp"
#include "http/handlers/outgoing.hpp"
#include "http/handlers/scans.hpp"
#include "http/handlers/settings.hpp"
#include "http/handlers/system.hpp"
#include "http/handlers/turntable.hpp"
#include "http/json_body.hpp"
#include "http/place.hpp"
#include "http/same_origin.hpp"
#include "http/scan_view.hpp"
#include "log.hpp"

namespace octurn {

/// A handler takes only what it needs: the request, and the variable parts of its path.
using Handler =
    std::variant<Response (*)(App&), Response (*)(App&, const Request&),
                 Response (*)(EventFeed&, const Request&), Response (*)(App&, std::string_view id),
                 Response (*)(App&, const Request&, std::string_view id),
                 Response (*)(App&, std::string_view id, std::string_view number),
                 Response (*)(App&, const Request&, std::string_view id, std::string_view number)>;

/// What a handler may wait for, up to some seconds: a frame of the sensor, or the start of devices.
enum class WaitsFor { nothing, look, start };

/// The handler of a method and a path, with `{id}` and `{number}` for its variable parts.
struct Route {
  std::string_view method;
  std::string_view path;
  Handler handler;
  WaitsFor waits_for = WaitsFor::nothing;
};

namespace {

// The path whose body is an upload, beside the archives of scans.
inline constexpr std::string_view update_path = "/api/v1/update";

constexpr const char* retry_after = "2";  // seconds: a file of a small model is made meanwhile

/// The path segments that match `{id}` and `{number}` of a route; empty if the route has none.
struct PathParts {
  std::string_view id = {};
  std::string_view number = {};
};

/// Removes the first segment of a path, and the slash after it. @return the segment
std::string_view take_part(std::string_view& path) {
  const std::string_view part = path.substr(0, path.find('/'));
  path.remove_prefix(std::min(part.size() + 1, path.size()));
  return part;
}

/// Matches a path with a route's, where `{id}` and `{number}` match any one segment each, and
/// `Scan.{format}` a model's file that is no STL.
std::optional<PathParts> match(std::string_view route, std::string_view path) {
  if (std::ranges::count(route, '/') != std::ranges::count(path, '/')) {
    return std::nullopt;
  }
  PathParts parts;
  while (!route.empty() || !path.empty()) {
    const std::string_view wanted = take_part(route);
    const std::string_view given = take_part(path);
    if (wanted == "{id}") {
      parts.id = given;
    } else if (wanted == "{number}") {
      parts.number = given;
    } else if (wanted == "Scan.{format}" ? !given.starts_with("Scan.") || given == "Scan.stl"
                                         : wanted != given) {
      return std::nullopt;
    }
  }
  return parts;
}

/// Visitor of a handler: calls it with the parameters that it takes.
struct Call {
  App& app;
  EventFeed& events;
  const Request& request;
  PathParts parts;

  Response operator()(Response (*handler)(App&)) const { return handler(app); }
  Response operator()(Response (*handler)(App&, const Request&)) const {
    return handler(app, request);
  }
  Response operator()(Response (*handler)(EventFeed&, const Request&)) const {
    return handler(events, request);
  }
  Response operator()(Response (*handler)(App&, std::string_view)) const {
    return handler(app, parts.id);
  }
  Response operator()(Response (*handler)(App&, const Request&, std::string_view)) const {
    return handler(app, request, parts.id);
  }
  Response operator()(Response (*handler)(App&, std::string_view, std::string_view)) const {
    return handler(app, parts.id, parts.number);
  }
  Response operator()(Response (*handler)(App&, const Request&, std::string_view,
                                          std::string_view)) const {
    return handler(app, request, parts.id, parts.number);
  }
};

/// Adds a method to the value of an Allow header.
void allow(std::string_view method, std::string& allowed) {
  allowed.append(allowed.empty() ? "" : ", ").append(method);
  allowed.append(method == "GET" ? ", HEAD" : "");
}

Response to_problem(const Error& error) {
  Response response = problem(to_failure(error));
  if (error.code() == ErrorCode::too_many) {
    response.headers.emplace_back("Retry-After", retry_after);
  }
  return response;
}

Response wrong_method(const Request& request, const std::string& allowed) {
  Response response = problem({.code = ErrorCode::wrong_method,
                               .detail = request.method + " is not for " + request.path,
                               .hint = "It takes " + allowed + "."});
  response.headers.emplace_back("Allow", allowed);
  return response;
}

std::span<const Route> scan_routes() {
  static const std::array all{
      Route{"GET", "/api/v1/scans", list_scans},
      Route{"POST", "/api/v1/scans", start_scan, WaitsFor::start},
      Route{"GET", "/api/v1/scans.csv", send_table},
      Route{"GET", "/api/v1/scans.zip", send_collection},
      Route{"POST", "/api/v1/scans/estimate", send_estimate},
      Route{"GET", "/api/v1/scans/{id}", send_scan},
      Route{"PATCH", "/api/v1/scans/{id}", label_scan},
      Route{"DELETE", "/api/v1/scans/{id}", remove_scan},
      Route{"POST", "/api/v1/scans/{id}/cancel", cancel_scan},
      Route{"POST", "/api/v1/scans/{id}/end", cancel_scan},
      Route{"POST", "/api/v1/scans/{id}/pause", pause_scan},
      Route{"POST", "/api/v1/scans/{id}/restore", restore_scan},
      Route{"POST", "/api/v1/scans/{id}/resume", resume_scan, WaitsFor::start},
      Route{"GET", "/api/v1/scans/{id}/Scan.stl", send_model},
      Route{"POST", import_path, import_scan},
      Route{"GET", "/api/v1/scans/{id}/scan.zip", send_archive},
      Route{"GET", "/api/v1/scans/{id}/Scan.{format}", send_mesh},
      Route{"GET", "/api/v1/scans/{id}/coarse.stl", send_coarse_model},
      Route{"GET", "/api/v1/scans/{id}/thumbnail.png", send_thumbnail},
      Route{"GET", "/api/v1/scans/{id}/preview.stl", send_preview},
      Route{"GET", "/api/v1/scans/{id}/builds", list_builds},
      Route{"POST", "/api/v1/scans/{id}/builds", start_build},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}", send_build},
      Route{"DELETE", "/api/v1/scans/{id}/builds/{number}", remove_build},
      Route{"POST", "/api/v1/scans/{id}/builds/{number}/cancel", cancel_build},
      Route{"POST", "/api/v1/scans/{id}/builds/{number}/choose", choose_build},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/Scan.stl", send_build_model},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/Scan.{format}", send_build_mesh},
      Route{"GET", "/api/v1/scans/{id}/builds/{number}/coarse.stl", send_coarse_build},
      Route{"GET", "/api/v1/scans/{id}/send", send_upload},
      Route{"POST", "/api/v1/scans/{id}/send", send_to_printer},
      Route{"DELETE", "/api/v1/scans/{id}/send", cancel_upload},
      Route{"GET", "/api/v1/scans/{id}/poses", list_poses},
      Route{"POST", "/api/v1/scans/{id}/poses", start_pose, WaitsFor::start},
      Route{"POST", "/api/v1/scans/{id}/poses/{number}", choose_pose},
      Route{"DELETE", "/api/v1/scans/{id}/poses/{number}", remove_pose},
      Route{"GET", "/api/v1/scans/{id}/poses/{number}/points", send_pose_points},
  };
  return all;
}

std::span<const Route> other_routes() {
  static const std::array all{
      Route{"GET", "/Scan.stl", send_newest_model},
      Route{"GET", "/api/v1/openapi.json", send_description},
      Route{"GET", "/api/v1/status", send_status},
      Route{"GET", "/api/v1/events", send_events},
      Route{"GET", "/api/v1/settings", send_settings},
      Route{"PATCH", "/api/v1/settings", change_settings},
      Route{"GET", "/api/v1/settings/backup", send_backup},
      Route{"POST", "/api/v1/settings/backup", restore_backup},
      Route{"PUT", "/api/v1/settings/password", set_page_password},
      Route{"GET", "/api/v1/keys", list_keys},
      Route{"POST", "/api/v1/keys", make_key},
      Route{"DELETE", "/api/v1/keys/{id}", revoke_key},
      Route{"GET", "/api/v1/webhooks", list_webhooks},
      Route{"POST", "/api/v1/webhooks", add_webhook},
      Route{"DELETE", "/api/v1/webhooks/{id}", remove_webhook},
      Route{"POST", "/api/v1/webhooks/{id}/test", test_webhook},
      Route{"GET", "/api/v1/printers", list_printers},
      Route{"POST", "/api/v1/printers", add_printer},
      Route{"PATCH", "/api/v1/printers/{id}", trust_printer},
      Route{"DELETE", "/api/v1/printers/{id}", remove_printer},
      Route{"GET", "/api/v1/calibration", send_calibration},
      Route{"PATCH", "/api/v1/calibration", change_calibration},
      Route{"POST", "/api/v1/calibration", start_calibration, WaitsFor::start},
      Route{"GET", "/api/v1/calibration/sensor-map", send_sensor_map},
      Route{"POST", "/api/v1/calibration/cancel", cancel_calibration},
      Route{"POST", "/api/v1/calibration/solve", solve_lens},
      Route{"GET", "/api/v1/calibration/board.pdf", send_board},
      Route{"POST", "/api/v1/calibration/undo", undo_calibration},
      Route{"GET", "/api/v1/preview/points", send_points, WaitsFor::look},
      Route{"GET", "/api/v1/turntable", send_turntable},
      Route{"POST", "/api/v1/turntable", move_turntable},
      Route{"GET", "/api/v1/doctor", send_findings, WaitsFor::look},
      Route{"GET", "/api/v1/diagnostics.zip", send_diagnostics, WaitsFor::look},
      Route{"GET", "/api/v1/preview/depth.png", send_depth_picture, WaitsFor::look},
      Route{"GET", "/api/v1/bin", send_bin},
      Route{"DELETE", "/api/v1/bin", empty_bin},
      Route{"GET", update_path, send_update_state},
      Route{"PUT", update_path, take_update},
      Route{"GET", "/api/v1/machine", send_machine},
      Route{"PATCH", "/api/v1/machine", change_machine},
      Route{"PUT", "/api/v1/machine/clock", set_clock},
      Route{"POST", "/api/v1/machine/restart", restart_machine},
      Route{"POST", "/api/v1/machine/shutdown", shut_machine_down},
      Route{"GET", "/api/v1/messages", send_messages},
      Route{"GET", "/api/v1/wifi", send_wifi_state},
      Route{"PUT", "/api/v1/wifi", join_wifi},
  };
  return all;
}

}  // namespace

Api::Api(App app) : app_(std::move(app)), events_(StatusNews(app_)) {
  app_.webhooks = std::make_unique<WebhookSender>(
      app_.addresses, [this, news = ScanNews()]() mutable { return news.next(app_); });
}

Response Api::answer(const Request& request) {
  try {
    const std::string_view body_type = request.path == update_path || request.path == import_path
                                           ? upload_type
                                           : "application/json";
    const auto refused = refusal(request, app_.settings.config().host_names, body_type);
    return refused ? problem(*refused) : packed(request, tagged(request, dispatch(request)));
  } catch (const Error& error) {
    return to_problem(error);
  } catch (const std::exception& error) {
    log::error("http", request.method + " " + request.path + ": " + error.what());
    return problem(
        {.code = ErrorCode::internal, .detail = error.what(), .hint = "Please report this."});
  }
}

std::vector<RouteName> Api::routes() {
  std::vector<RouteName> names;
  for (const std::span<const Route> part : {scan_routes(), other_routes()}) {
    for (const Route& route : part) {
      names.push_back({.method = route.method, .path = route.path});
    }
  }
  return names;
}

/// The semaphore that limits requests which wait as this route does; null: the route does not wait.
std::counting_semaphore<>* Api::places_for(const Route& route) {
  switch (route.waits_for) {
    case WaitsFor::look:
      return &looks_;
    case WaitsFor::start:
      return &starts_;
    case WaitsFor::nothing:
      break;
  }
  return nullptr;
}

Response Api::dispatch(const Request& request) {
  const std::string_view method = request.is_read() ? std::string_view("GET") : request.method;
  std::string allowed;
  for (const std::span<const Route> part : {scan_routes(), other_routes()}) {
    for (const Route& route : part) {
      const auto parts = match(route.path, request.path);
      if (parts && route.method == method) {
        const Place place(places_for(route), "others are waiting for the devices");
        try {
          return std::visit(Call{app_, events_, request, *parts}, route.handler);
        } catch (const Error&) {
          if (request.is_read() && route.path.starts_with("/api/v1/scans/{id}")) {
            find_scan(app_, parts->id);  // throws if the scan was deleted meanwhile, with its files
          }
          throw;
        }
      }
      if (parts) {
        allow(route.method, allowed);
      }
    }
  }
  if (allowed.empty() && request.is_read() && !request.path.starts_with("/api/")) {
    return app_.page.file(request);
  }
  if (allowed.empty()) {
    throw Error(ErrorCode::not_found, "there is no " + request.path,
                "Check the address. Those of this version begin with /api/v1/.");
  }
  return wrong_method(request, allowed);
}

}  // namespace octurn
