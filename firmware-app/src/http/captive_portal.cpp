#include "http/captive_portal.hpp"

#include "http/same_origin.hpp"

namespace octurn {
namespace {

/// The page's address in the hotspot, as in image-build's hotspot.network.
constexpr const char* page_address = "http://192.168.77.1/";

}  // namespace

std::optional<Response> captive_answer(const Request& request,
                                       std::span<const std::string> host_names,
                                       const Appliance& appliance) {
  if (!request.is_read() || is_own_host(request.header("Host").value_or(""), host_names) ||
      appliance.wifi().state != "hotspot") {
    return std::nullopt;
  }
  // Phones show the target of a redirect. They take an answer of status 200 for the internet's.
  return Response{.status = 302,
                  .headers = {{"Location", page_address}, {"Cache-Control", "no-store"}}};
}

}  // namespace octurn
