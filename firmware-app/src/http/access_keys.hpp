#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "http/message.hpp"

namespace octurn {

/// The rights of a program with a key.
enum class KeyAccess {
  read,  ///< GET and HEAD
  full,  ///< everything except setting the password and making keys, as a key can be overheard
};

/// A program's key as it is stored: only its hash, not the key itself.
struct AccessKey {
  std::string id = {};    ///< eight hexadecimal digits with which the key begins
  std::string name = {};  ///< display name
  KeyAccess access = KeyAccess::read;
  std::string created = {};  ///< RFC 3339
  std::string hash = {};     ///< of crypt(5): SHA-256 with a salt
};

std::string_view to_string(KeyAccess access);
std::optional<KeyAccess> to_key_access(std::string_view word);

/// Keys of programs for the interface (RFC 6750), besides the page's password for people. They are
/// stored in a file that only its owner can read. Thread-safe.
class AccessKeys {
 public:
  static constexpr std::size_t max_keys = 32;

  /// @param file  read if it exists; no key of a malformed file is valid
  explicit AccessKeys(std::filesystem::path file);

  /// All keys, oldest first.
  std::vector<AccessKey> all() const;

  struct NewKey {
    AccessKey kept = {};   ///< as stored
    std::string key = {};  ///< the key itself, available only here
  };

  /// Makes a key.
  /// @throws Error "bad-settings" if there are max_keys; "disk-full", "write-failed"
  NewKey add(const std::string& name, KeyAccess access, std::chrono::system_clock::time_point now);

  /// Removes the key of that id. @return false if there is none
  /// @throws Error "disk-full", "write-failed"
  bool revoke(std::string_view id);

  /// The rights of a key; nothing if it is invalid.
  std::optional<KeyAccess> access(std::string_view key) const;

 private:
  void write(const std::vector<AccessKey>& keys) const;

  const std::filesystem::path file_;
  mutable std::mutex mutex_ = {};  // guards keys_, and the file
  std::vector<AccessKey> keys_ = {};
};

/// The key that a request is sent with, as `Authorization: Bearer KEY`; nothing without one.
std::optional<std::string_view> key_in(const Request& request);

/// The refusal of a request with a key: 401 if the key is invalid, 403 if its rights are not
/// enough. Nothing if the request is admitted. Keys are checked even if the page has no password.
std::optional<Response> refuse_key(const AccessKeys& keys, const Request& request,
                                   std::string_view key);

}  // namespace octurn
