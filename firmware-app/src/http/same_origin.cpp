#include "http/same_origin.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <optional>

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

using IpAddress = std::array<unsigned char, sizeof(in6_addr)>;

/// The bytes of an IP address, those of IPv4 as mapped into IPv6; nothing if it is none.
std::optional<IpAddress> to_ip_address(const std::string& text) {
  IpAddress address{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  constexpr std::size_t before_ipv4 = 12;
  if (::inet_pton(AF_INET, text.c_str(), &address[before_ipv4]) == 1 ||
      ::inet_pton(AF_INET6, text.c_str(), address.data()) == 1) {
    return address;
  }
  return std::nullopt;
}

/// Whether a text is the address of a trusted proxy.
bool is_trusted(const std::string& text, std::span<const std::string> trusted_proxies) {
  const auto address = to_ip_address(text);
  return address && std::ranges::any_of(trusted_proxies, [&](const std::string& proxy) {
           return to_ip_address(proxy) == address;
         });
}

/// Removes the last of the values that a header lists after commas, and returns it.
std::string take_last(std::string_view& values) {
  const std::size_t comma = values.rfind(',');
  std::string_view last = values.substr(comma == std::string_view::npos ? 0 : comma + 1);
  values = values.substr(0, comma == std::string_view::npos ? 0 : comma);
  last.remove_prefix(std::min(last.find_first_not_of(' '), last.size()));
  return std::string(last.substr(0, last.find_last_not_of(' ') + 1));
}

/// The last header of a name: that which the nearest proxy has written.
std::string_view last_header(const Request& request, std::string_view name) {
  std::string_view value;
  for (const auto& [header, text] : request.headers) {
    value = same_token(header, name) ? std::string_view(text) : value;
  }
  return value;
}

bool ends_with_domain(std::string_view name, std::string_view domain) {
  return name.size() > domain.size() &&
         same_token(name.substr(name.size() - domain.size()), domain);
}

bool is_ours(const std::string& name, std::span<const std::string> host_names) {
  return to_ip_address(name) || (!name.empty() && name.find_first_of(".@[") == std::string::npos) ||
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

/// What a proxy before the scanner has to be told if its host does not arrive.
std::string proxy_hint(const Request& request) {
  return request.header("X-Forwarded-Host")
             ? "A proxy before it has to pass the header Host on as it is, or its address has to "
               "stand in trusted_proxies in octurn.json."
             : "A proxy before it has to pass the header Host on as it is.";
}

/// The page's address in the hotspot, as in image-build's hotspot.network.
constexpr const char* page_address = "http://192.168.77.1/";

/// Whether a `Host` is an IP address or a name of this host.
/// @param host_names  besides the local ones
bool is_own_host(std::string_view host, std::span<const std::string> host_names) {
  return is_ours(to_host_name(host), host_names);
}

}  // namespace

void take_forwarded(Request& request, std::string& address,
                    std::span<const std::string> trusted_proxies) {
  if (!is_trusted(address, trusted_proxies)) {
    return;
  }
  std::string_view hosts = last_header(request, "X-Forwarded-Host");
  std::string_view clients = last_header(request, "X-Forwarded-For");
  std::string client = address;
  while (is_trusted(client, trusted_proxies) && !clients.empty()) {
    client = take_last(clients);
  }
  if (to_ip_address(client)) {
    address = std::move(client);
  }
  if (std::string host = take_last(hosts); !host.empty()) {
    request.headers.insert(request.headers.begin(), {"Host", host});  // the first is in force
  }
}

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
                   .hint = "Use the scanner's own page. " + proxy_hint(request)};
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
