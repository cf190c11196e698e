#include "http/api.hpp"

#include <array>
#include <optional>
#include <utility>
#include <variant>

#include "http/handlers/appliance.hpp"
#include "http/handlers/calibration.hpp"
#include "http/handlers/models.hpp"
#include "http/handlers/scans.hpp"
#include "http/handlers/settings.hpp"
#include "http/handlers/system.hpp"
#include "http/handlers/turntable.hpp"
#include "http/problem.hpp"
#include "http/same_origin.hpp"
#include "log.hpp"

namespace octurn {
namespace {

constexpr std::string_view update_path = "/api/v1/update";

/// Whether a path is as a route has it; `{id}` stands for any one part.
/// @return the part, empty if the route has none; nothing if they differ
std::optional<std::string_view> match(std::string_view route, std::string_view path) {
  constexpr std::string_view id = "{id}";
  const std::size_t at = route.find(id);
  if (at == std::string_view::npos) {
    return route == path ? std::optional<std::string_view>("") : std::nullopt;
  }
  const std::string_view rest = route.substr(at + id.size());
  if (path.size() <= at || path.substr(0, at) != route.substr(0, at)) {
    return std::nullopt;
  }
  const std::string_view part = path.substr(at, path.find('/', at) - at);
  return path.substr(at + part.size()) == rest ? std::optional(part) : std::nullopt;
}

/// A handler takes what it needs of the request and the `{id}` of its path.
using Handler = std::variant<Response (*)(App&), Response (*)(App&, const Request&),
                             Response (*)(App&, std::string_view id),
                             Response (*)(App&, const Request&, std::string_view id)>;

/// Calls any of the handlers.
struct Call {
  App& app;
  const Request& request;
  std::string_view id;

  Response operator()(Response (*handler)(App&)) const { return handler(app); }
  Response operator()(Response (*handler)(App&, const Request&)) const {
    return handler(app, request);
  }
  Response operator()(Response (*handler)(App&, std::string_view)) const {
    return handler(app, id);
  }
  Response operator()(Response (*handler)(App&, const Request&, std::string_view)) const {
    return handler(app, request, id);
  }
};

/// What a handler may wait for, for seconds.
enum class WaitsFor { nothing, look, start };

/// Holds one of the places that a semaphore counts.
class Place {
 public:
  /// @throws Error "too-many"  if all are taken
  explicit Place(std::counting_semaphore<>& places) : places_(places) {
    if (!places_.try_acquire()) {
      throw Error(ErrorCode::too_many, "others are waiting for the devices already",
                  "Try again soon.");
    }
  }
  ~Place() { places_.release(); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  std::counting_semaphore<>& places_;
};

Response wrong_method(const Request& request, const std::string& allowed) {
  Response response = problem({.code = ErrorCode::wrong_method,
                               .detail = request.method + " is not for " + request.path,
                               .hint = "It takes " + allowed + "."});
  response.headers.emplace_back("Allow", allowed);
  return response;
}

}  // namespace

struct Api::Route {
  std::string_view method;
  std::string_view path;
  Handler handler;
  WaitsFor waits_for = WaitsFor::nothing;
};

Api::Api(App app) : app_(std::move(app)) {}

Response Api::answer(const Request& request) {
  try {
    const std::string_view body_type =
        request.path == update_path ? upload_type : "application/json";
    const auto refused = refusal(request, app_.settings.config().host_names, body_type);
    return refused ? problem(*refused) : dispatch(request);
  } catch (const Error& error) {
    return problem(to_failure(error));
  } catch (const std::exception& error) {
    log::error("http", request.method + " " + request.path + ": " + error.what());
    return problem(
        {.code = ErrorCode::internal, .detail = error.what(), .hint = "Please report this."});
  }
}

Response Api::dispatch(const Request& request) {
  static const std::array routes{
      Route{"GET", "/Scan.stl", send_newest_model},
      Route{"GET", "/api/v1/status", send_status},
      Route{"GET", "/api/v1/settings", send_settings},
      Route{"PATCH", "/api/v1/settings", change_settings},
      Route{"GET", "/api/v1/settings/backup", send_backup},
      Route{"POST", "/api/v1/settings/backup", restore_backup},
      Route{"PUT", "/api/v1/settings/password", set_page_password},
      Route{"GET", "/api/v1/calibration", send_calibration},
      Route{"PATCH", "/api/v1/calibration", change_calibration},
      Route{"POST", "/api/v1/calibration", start_calibration, WaitsFor::start},
      Route{"GET", "/api/v1/calibration/sensor-map", send_sensor_map},
      Route{"POST", "/api/v1/calibration/cancel", cancel_calibration},
      Route{"POST", "/api/v1/calibration/undo", undo_calibration},
      Route{"GET", "/api/v1/preview/points", send_points, WaitsFor::look},
      Route{"GET", "/api/v1/turntable", send_turntable},
      Route{"POST", "/api/v1/turntable", move_turntable},
      Route{"GET", "/api/v1/doctor", send_findings, WaitsFor::look},
      Route{"GET", "/api/v1/diagnostics.zip", send_diagnostics, WaitsFor::look},
      Route{"GET", "/api/v1/preview/depth.png", send_depth_picture, WaitsFor::look},
      Route{"GET", "/api/v1/scans", list_scans},
      Route{"POST", "/api/v1/scans", start_scan, WaitsFor::start},
      Route{"GET", "/api/v1/scans/{id}", send_scan},
      Route{"PATCH", "/api/v1/scans/{id}", rename_scan},
      Route{"DELETE", "/api/v1/scans/{id}", remove_scan},
      Route{"POST", "/api/v1/scans/{id}/cancel", cancel_scan},
      Route{"POST", "/api/v1/scans/{id}/resume", resume_scan, WaitsFor::start},
      Route{"GET", "/api/v1/scans/{id}/Scan.stl", send_model},
      Route{"GET", "/api/v1/scans/{id}/preview.stl", send_preview},
      Route{"GET", update_path, send_update_state},
      Route{"PUT", update_path, take_update},
      Route{"GET", "/api/v1/machine", send_machine},
      Route{"PATCH", "/api/v1/machine", change_machine},
      Route{"GET", "/api/v1/wifi", send_wifi_state},
      Route{"PUT", "/api/v1/wifi", join_wifi},
  };
  const std::string_view method = request.is_read() ? std::string_view("GET") : request.method;
  std::string allowed;
  for (const Route& route : routes) {
    const auto id = match(route.path, request.path);
    if (id && route.method == method) {
      return call(route, request, *id);
    }
    if (id) {
      allowed.append(allowed.empty() ? "" : ", ").append(route.method);
      allowed.append(route.method == "GET" ? ", HEAD" : "");
    }
  }
  if (allowed.empty() && request.is_read()) {
    return app_.page.file(request);
  }
  if (allowed.empty()) {
    throw Error(ErrorCode::not_found, "there is no " + request.path,
                "web/API.md lists what there is.");
  }
  return wrong_method(request, allowed);
}

Response Api::call(const Route& route, const Request& request, std::string_view id) {
  std::optional<Place> place;
  if (route.waits_for != WaitsFor::nothing) {
    place.emplace(route.waits_for == WaitsFor::look ? looks_ : starts_);
  }
  return std::visit(Call{app_, request, id}, route.handler);
}

}  // namespace octurn
