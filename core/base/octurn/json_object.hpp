#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {

/// A value of an untrusted JSON document, with its path. Every message has the path, the value and
/// the rule: `"sensor.width" is 0: must be a whole number from 2 to 8192`.
class JsonValue {
 public:
  /// @param value  must outlive this
  /// @param name   its path, "sensor.width" or "snapshots[1]"; empty for the whole document
  /// @param code   of the errors that this value throws, such as "bad-settings"
  JsonValue(const nlohmann::json& value, std::string name, ErrorCode code);

  const nlohmann::json& json() const { return value_; }
  const std::string& name() const { return name_; }
  ErrorCode code() const { return code_; }

  /// The value as a C++ type. @throws Error  if it has another type or is out of range
  double number() const;
  double number(double min, double max) const;
  int whole_number(int min, int max) const;
  bool flag() const;
  std::string text() const;

  /// An array's elements, named "name[0]" and so on. @throws Error  if it is not an array
  std::vector<JsonValue> elements() const;
  /// As above. @throws Error  if it is not an array of `count` elements
  std::vector<JsonValue> elements(std::size_t count) const;

  /// Throws an Error that refuses the value. @param must  completes "... must be"
  [[noreturn]] void refuse(const std::string& must) const;

 private:
  const nlohmann::json& value_;
  std::string name_;
  ErrorCode code_;
};

/// An untrusted JSON object. It remembers the keys that were read, so that `refuse_unread` finds
/// misspelt ones.
class JsonObject {
 public:
  /// @throws Error  if it is not an object
  explicit JsonObject(JsonValue object);
  JsonObject(const nlohmann::json& object, ErrorCode code, std::string name);

  /// The value of a required key. @throws Error  if it is missing
  JsonValue at(std::string_view key);

  /// The value of an optional key.
  std::optional<JsonValue> value(std::string_view key);

  /// An optional key's value as a C++ type. @throws Error  if it has another type or is out of
  /// range
  std::optional<double> number(std::string_view key, double min, double max);
  std::optional<int> whole_number(std::string_view key, int min, int max);
  std::optional<bool> flag(std::string_view key);
  std::optional<std::string> text(std::string_view key);

  /// The JSON of an optional key; null if it is absent.
  const nlohmann::json* find(std::string_view key);

  /// @throws Error  if the object has a key that was not read
  void refuse_unread() const;

  /// Throws an Error that refuses a key's value. @param must  completes "... must be"
  [[noreturn]] void refuse(std::string_view key, const nlohmann::json& value,
                           const std::string& must) const;

 private:
  std::string path_to(std::string_view key) const;

  JsonValue object_;
  std::set<std::string, std::less<>> read_ = {};
};

/// Maximum nesting of arrays and objects. Copying, comparing and writing a value recurse to its
/// depth, and some threads have a stack of 100 KB.
inline constexpr int max_json_depth = 32;

/// Maximum size of a document, bytes: room for 40,000 snapshots with poses.
inline constexpr std::size_t max_json_bytes = std::size_t{16} << 20U;

/// Limits of an untrusted document. The text's size alone does not bound the memory of its values:
/// an empty array has 3 bytes of text, and takes about 230 when it is read as an element.
struct JsonLimits {
  std::size_t bytes = max_json_bytes;
  std::size_t values = 1'000'000;  ///< 40,000 snapshots with poses have 920,000
};

/// Parses an untrusted JSON text. All JSON that the library and the program read goes through it.
///
/// @param code  of the errors
/// @param what  the text's name in messages: "the body"
/// @throws Error  of that code, if the text is not JSON, nested too deeply, too large, or has too
///                many values
nlohmann::json parse_json(std::string_view text, ErrorCode code, const std::string& what,
                          const JsonLimits& limits = {});

/// Whether a text is UTF-8, as JSON must be.
bool is_utf8(const std::string& text);

}  // namespace octurn
