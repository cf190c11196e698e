#include "http/key_login.hpp"

#include "http/problem.hpp"

namespace octurn {
namespace {

/// Whether a path manages the keys or the password.
bool is_about_access(std::string_view path) {
  return path == "/api/v1/keys" || path.starts_with("/api/v1/keys/") ||
         path == "/api/v1/settings/password";
}

Response refuse(const HttpProblem& reason, const std::string& error) {
  Response response = to_response(reason);
  response.headers.emplace_back("WWW-Authenticate",
                                R"(Bearer realm="Octurn", error=")" + error + "\"");
  return response;
}

Response forbid(std::string_view detail, std::string_view hint) {
  return refuse({.status = 403,
                 .title = "The key does not allow that",
                 .code = "key-not-enough",
                 .detail = detail,
                 .hint = hint},
                "insufficient_scope");
}

}  // namespace

std::optional<std::string_view> key_in(const Request& request) {
  constexpr std::string_view scheme = "Bearer ";
  std::string_view given = request.header("Authorization").value_or("");
  if (given.size() < scheme.size() || !same_token(given.substr(0, scheme.size()), scheme)) {
    return std::nullopt;
  }
  given.remove_prefix(scheme.size());
  return given;
}

std::optional<Response> refuse_key(const AccessKeys& keys, const Request& request,
                                   std::string_view key) {
  const auto access = keys.access(key);
  if (!access) {
    return refuse({.status = 401,
                   .title = "The access key is not valid",
                   .code = "wrong-key",
                   .detail = "there is no such key, or it was revoked",
                   .hint = "Make a new key in the page's settings."},
                  "invalid_token");
  }
  if (is_about_access(request.path)) {
    return forbid("no key sets the password or makes keys", "Do it in the page's settings.");
  }
  if (*access == KeyAccess::read && !request.is_read()) {
    return forbid("this key is for reading", "Make one for everything in the page's settings.");
  }
  return std::nullopt;
}

}  // namespace octurn
