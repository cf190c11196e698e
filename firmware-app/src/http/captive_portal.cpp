#include "http/captive_portal.hpp"

#include "http/same_origin.hpp"

namespace octurn {
namespace {

/// Of the page there, as image-build's hotspot.network has it.
constexpr const char* page_address = "http://192.168.77.1/";

}  // namespace

std::optional<Response> captive_answer(const Request& request,
                                       std::span<const std::string> host_names,
                                       const Appliance& appliance) {
  if (!request.is_read() || is_own_host(request.header("Host").value_or(""), host_names) ||
      appliance.wifi().state != "hotspot") {
    return std::nullopt;
  }
  // Phones show what a redirect leads to, and take a page of the status 200 for the internet's.
  return Response{.status = 302,
                  .headers = {{"Location", page_address}, {"Cache-Control", "no-store"}}};
}

}  // namespace octurn
