#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace octurn {

/// A JSON object from outside: its keys are read one by one, checked, and those that nobody has
/// read are refused at the end. Every message names the key, its value and what it must be.
class JsonObject {
 public:
  /// @param code  of the errors that this object throws, such as "bad-settings"
  /// @param name  of the object in messages; empty for the outermost
  /// @throws Error  if it is no object
  JsonObject(const nlohmann::json& object, std::string code, std::string name);

  /// The value of that key, or null if it is not there.
  const nlohmann::json* find(std::string_view key);

  /// The value of that key, or nothing if it is not there.
  /// @throws Error  if it is of another kind or out of its range
  std::optional<double> number(std::string_view key, double least, double most);
  std::optional<int> whole_number(std::string_view key, int least, int most);
  std::optional<bool> flag(std::string_view key);
  std::optional<std::string> text(std::string_view key);

  /// @throws Error  if there is a key that nobody has asked for
  void refuse_unread() const;

  /// @param must  completes "... is VALUE: must be"
  [[noreturn]] void refuse(std::string_view key, const nlohmann::json& value,
                           const std::string& must) const;

 private:
  std::string quoted(std::string_view key) const;

  const nlohmann::json& object_;
  std::string code_;
  std::string name_;
  std::set<std::string, std::less<>> read_ = {};
};

/// Arrays and objects inside one another that a document may have. Copying, comparing and writing
/// a value recurse by its depth, on stacks as small as 100 KB.
inline constexpr int max_json_depth = 32;

/// Bytes of a document: 40,000 snapshots with a pose each. As values they take up to 16 times that.
inline constexpr std::size_t max_json_bytes = std::size_t{16} << 20U;

/// Parses a JSON text from outside. Every reader of JSON in the program goes through here.
///
/// @param what  the text's name in messages: "the body"
/// @throws Error  of that code, if the text is not JSON, too deep or too large
nlohmann::json parse_json(std::string_view text, const std::string& code, const std::string& what);

}  // namespace octurn
