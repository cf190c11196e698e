#include "http/access_keys.hpp"

#include <crypt.h>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "http/json_body.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "random_digits.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_keys_bytes = std::size_t{64} * 1024;
constexpr std::size_t id_bytes = 4;

// A key is "octurn", its id and its secret, with dashes between them.
constexpr std::string_view key_begin = "octurn-";

// SHA-256 of crypt(5) with the minimum of rounds: more rounds protect passwords that people choose,
// and keys are random.
constexpr const char* hash_method = "$5$";
constexpr unsigned long hash_rounds = 1000;

/// Hashes a key by crypt(3).
/// @param setting  a salt, or a hash, whose salt is used @return empty if it is neither
std::string hash_with(const std::string& key, const std::string& setting) {
  const auto room = std::make_unique<crypt_data>();  // too large for the stack of a server's thread
  const char* const hash = ::crypt_r(key.c_str(), setting.c_str(), room.get());
  return hash != nullptr && *hash != '*' ? hash : "";
}

std::string make_hash(const std::string& key) {
  std::array<char, CRYPT_GENSALT_OUTPUT_SIZE> salt{};
  if (::crypt_gensalt_rn(hash_method, hash_rounds, nullptr, 0, salt.data(), salt.size()) ==
      nullptr) {
    throw Error(ErrorCode::internal, "the system cannot hash a key");
  }
  return hash_with(key, salt.data());
}

AccessKey to_key(const JsonValue& value) {
  JsonObject object(value);
  AccessKey key{.id = object.at("id").text(), .name = object.at("name").text()};
  const JsonValue access = object.at("access");
  const auto known = to_key_access(access.text());
  if (!known) {
    access.refuse(R"("read" or "full")");
  }
  key.access = *known;
  key.created = object.at("created").text();
  key.hash = object.at("hash").text();
  object.refuse_unread();
  return key;
}

std::vector<AccessKey> read_keys(const std::filesystem::path& file) try {
  std::vector<AccessKey> keys;
  if (const auto text = read_regular_file(file, max_keys_bytes)) {
    const json document = parse_json(*text, ErrorCode::bad_settings, "the keys");
    JsonObject object(document, ErrorCode::bad_settings, "");
    for (const JsonValue& value : object.at("keys").elements()) {
      keys.push_back(to_key(value));
    }
  }
  return keys;
} catch (const Error& error) {
  log::warning("http", file.string() + ": " + error.what() + "; all access keys are refused");
  return {};
}

}  // namespace

std::string_view to_string(KeyAccess access) { return access == KeyAccess::read ? "read" : "full"; }

std::optional<KeyAccess> to_key_access(std::string_view word) {
  return word == "read"   ? std::optional(KeyAccess::read)
         : word == "full" ? std::optional(KeyAccess::full)
                          : std::nullopt;
}

AccessKeys::AccessKeys(std::filesystem::path file)
    : file_(std::move(file)), keys_(read_keys(file_)) {}

std::vector<AccessKey> AccessKeys::all() const {
  const std::lock_guard lock(mutex_);
  return keys_;
}

/// Writes the file. Callers write before a change takes effect, so that no crash can undo it.
void AccessKeys::write(const std::vector<AccessKey>& keys) const {
  json all = json::array();
  for (const AccessKey& key : keys) {
    all.push_back({{"id", key.id},
                   {"name", key.name},
                   {"access", to_string(key.access)},
                   {"created", key.created},
                   {"hash", key.hash}});
  }
  write_file(file_, json{{"keys", std::move(all)}}.dump(2) + "\n", 0600);
}

AccessKeys::NewKey AccessKeys::add(const std::string& name, KeyAccess access,
                                   std::chrono::system_clock::time_point now) {
  const std::string id = random_digits(id_bytes);
  const std::string key = std::string(key_begin) + id + "-" + random_digits(secret_bytes);
  const std::lock_guard lock(mutex_);
  if (keys_.size() >= max_keys) {
    throw Error(ErrorCode::bad_settings, "there are " + std::to_string(max_keys) + " keys already",
                "Revoke one that is no longer used.");
  }
  std::vector<AccessKey> keys = keys_;
  keys.push_back({.id = id,
                  .name = name,
                  .access = access,
                  .created = utc_text(now, rfc3339),
                  .hash = make_hash(key)});
  write(keys);
  keys_ = std::move(keys);
  return {.kept = keys_.back(), .key = key};
}

bool AccessKeys::revoke(std::string_view id) {
  const std::lock_guard lock(mutex_);
  std::vector<AccessKey> keys = keys_;
  if (std::erase_if(keys, [&](const AccessKey& key) { return key.id == id; }) == 0) {
    return false;
  }
  write(keys);
  keys_ = std::move(keys);
  return true;
}

std::optional<KeyAccess> AccessKeys::access(std::string_view key) const {
  if (!key.starts_with(key_begin)) {
    return std::nullopt;
  }
  const std::string_view id = key.substr(key_begin.size(), 2 * id_bytes);
  const std::vector<AccessKey> keys = all();
  const auto found = std::ranges::find(keys, id, &AccessKey::id);
  if (found == keys.end() || found->hash.empty() ||
      hash_with(std::string(key), found->hash) != found->hash) {
    return std::nullopt;
  }
  return found->access;
}

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
