#include "http/same_origin.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

namespace octurn {
namespace {

// Top-level names that nobody can register in the public DNS: RFC 6762 (.local), RFC 8375
// (home.arpa), ICANN 2024 (.internal), and those that home routers use.
constexpr std::array<std::string_view, 6> local_domains{".local",    ".localhost",   ".home.arpa",
                                                        ".internal", ".localdomain", ".lan"};

/// "scanner.local" of "scanner.local:8080" and of "scanner.local.", "::1" of "[::1]:8080"; empty if
/// what follows is no port.
std::string to_host_name(std::string_view host) {
  const bool is_bracketed = host.starts_with('[');
  const std::size_t end = is_bracketed ? host.find(']') : host.find(':');
  std::string_view name = host.substr(0, end);
  std::string_view rest = end == std::string_view::npos ? "" : host.substr(end);
  if (is_bracketed && !rest.empty()) {
    name.remove_prefix(1);
    rest.remove_prefix(1);
  }
  if (!rest.empty() &&
      (rest.front() != ':' || rest.find_first_not_of("0123456789", 1) != std::string_view::npos)) {
    return "";
  }
  return std::string(name.ends_with('.') ? name.substr(0, name.size() - 1) : name);
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, name.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), address.data()) == 1;
}

bool ends_with_domain(std::string_view name, std::string_view domain) {
  return name.size() > domain.size() &&
         same_token(name.substr(name.size() - domain.size()), domain);
}

bool is_ours(const std::string& name, std::span<const std::string> host_names) {
  return is_address(name) || (!name.empty() && name.find_first_of(".@[") == std::string::npos) ||
         std::ranges::any_of(local_domains,
                             [&](auto domain) { return ends_with_domain(name, domain); }) ||
         std::ranges::any_of(host_names, [&](const auto& ours) { return same_token(name, ours); });
}

/// Whether an `Origin` ("http://scanner.local:8080") is that of the page this host serves.
bool is_same_origin(std::string_view origin, std::string_view host) {
  const std::size_t scheme = origin.find("://");
  return scheme != std::string_view::npos && same_token(origin.substr(scheme + 3), host);
}

/// Whether a body follows, by the request's head.
bool has_body(const Request& request) {
  return request.header("Content-Length").value_or("0") != "0" ||
         request.header("Transfer-Encoding").has_value();
}

/// Whether the request names the type of its body, or has neither: pages of other sites, which may
/// send a form without asking, are refused by their Origin.
bool has_type(const Request& request, std::string_view body_type) {
  const auto type = request.header("Content-Type");
  return body_type == upload_type
             ? is_upload(request)
             : is_of_type(type.value_or(""), body_type) || (!type && !has_body(request));
}

/// The page's address in the hotspot, as in image-build's hotspot.network.
constexpr const char* page_address = "http://192.168.77.1/";

/// Whether a `Host` is an IP address or a name of this host.
/// @param host_names  besides the local ones
bool is_own_host(std::string_view host, std::span<const std::string> host_names) {
  return is_ours(to_host_name(host), host_names);
}

}  // namespace

std::optional<Failure> refusal(const Request& request, std::span<const std::string> host_names,
                               std::string_view body_type) {
  const std::string_view host = request.header("Host").value_or("");
  if (!is_own_host(host, host_names)) {
    return Failure{.code = ErrorCode::wrong_host,
                   .detail = "\"" + std::string(host) + "\" is not a name of this scanner",
                   .hint =
                       "Open the page by the scanner's address, or add the name to host_names "
                       "in octurn.json."};
  }
  if (request.is_read() && request.path.starts_with("/api/") &&
      request.header("Sec-Fetch-Site") == "cross-site") {
    return Failure{.code = ErrorCode::wrong_origin,
                   .detail = "the request comes from a page of another site",
                   .hint = "Use the scanner's own page."};
  }
  if (request.is_read()) {
    return std::nullopt;
  }
  if (const auto origin = request.header("Origin"); origin && !is_same_origin(*origin, host)) {
    return Failure{.code = ErrorCode::wrong_origin,
                   .detail = "the request comes from " + std::string(*origin) + ", and is for " +
                             std::string(host),
                   .hint =
                       "Use the scanner's own page. A proxy before it has to pass the header "
                       "Host on as it is."};
  }
  if (request.method != "DELETE" && !has_type(request, body_type)) {
    return Failure{.code = ErrorCode::wrong_content_type,
                   .detail = request.method + " needs Content-Type: " + std::string(body_type),
                   .hint = "Send the body in that format, and name it in the header Content-Type."};
  }
  return std::nullopt;
}

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
