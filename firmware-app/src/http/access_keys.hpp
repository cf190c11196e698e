#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octurn {

/// What a program with a key may do.
enum class KeyAccess {
  read,  ///< GET and HEAD
  full,  ///< all but set the password and make keys: who overhears it does not own the scanner
};

/// A key that was given to a program. The key itself is not kept.
struct AccessKey {
  std::string id = {};    ///< eight hexadecimal digits, which the key begins with
  std::string name = {};  ///< for people: what it was made for
  KeyAccess access = KeyAccess::read;
  std::string created = {};  ///< RFC 3339
  std::string hash = {};     ///< of crypt(5): SHA-256 with a salt
};

std::string_view to_string(KeyAccess access);
std::optional<KeyAccess> to_key_access(std::string_view word);

/// Keys by which programs prove, beside people with the page's password, that they may use the
/// interface (RFC 6750). They are kept in a file that only its owner can read. Any thread may call
/// it.
class AccessKeys {
 public:
  static constexpr std::size_t max_keys = 32;

  /// @param file  of an earlier run, if there is one; of one that is malformed no key counts
  explicit AccessKeys(std::filesystem::path file);

  /// The oldest first.
  std::vector<AccessKey> all() const;

  struct NewKey {
    AccessKey kept = {};
    std::string key = {};  ///< itself, which is told this once
  };

  /// Makes a key.
  /// @throws Error "bad-settings" if there are max_keys; "disk-full", "write-failed"
  NewKey add(const std::string& name, KeyAccess access, std::chrono::system_clock::time_point now);

  /// @return false if there is none @throws Error "disk-full", "write-failed"
  bool revoke(std::string_view id);

  /// What a key lets its owner do; nothing if it is none.
  std::optional<KeyAccess> access(std::string_view key) const;

 private:
  void write(const std::vector<AccessKey>& keys) const;

  const std::filesystem::path file_;
  mutable std::mutex mutex_ = {};  // guards keys_, and the file
  std::vector<AccessKey> keys_ = {};
};

}  // namespace octurn
