#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "commands/commands.hpp"
#include "config/config_store.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_file_bytes = std::size_t{1} << 20U;
constexpr unsigned for_all_to_read = 0644;

/// Parses a JSON number, boolean, string or null. Any other text becomes a string.
json to_value(const std::string& text) {
  json value = json::parse(text, nullptr, false);
  return value.is_discarded() || value.is_structured() ? json(text) : value;
}

/// Converts `turntable.gear_ratio=4` to `{"turntable": {"gear_ratio": 4}}`; a key may stand deeper,
/// as `laser.left.line`.
/// @throws Error "bad-settings"
json to_change(const std::string& assignment) {
  if (!is_utf8(assignment)) {
    throw Error(ErrorCode::bad_settings, "a setting's text is not UTF-8",
                "Save its file as UTF-8.");
  }
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw Error(ErrorCode::bad_settings, "\"" + assignment + "\" is no setting: must be KEY=VALUE");
  }
  std::string key = assignment.substr(0, equals);
  json change = to_value(assignment.substr(equals + 1));
  for (auto dot = key.rfind('.'); dot != key.npos; dot = key.rfind('.')) {
    change = json{{key.substr(dot + 1), std::move(change)}};
    key.resize(dot);
  }
  return {{key, std::move(change)}};
}

json read_object(const std::filesystem::path& file) {
  const std::optional<std::string> text = read_regular_file(file, max_file_bytes);
  return text ? parse_json(*text, ErrorCode::bad_config, file.string()) : json::object();
}

}  // namespace

void set(const SetArguments& arguments) {
  json values = read_object(arguments.file);
  for (const std::string& assignment : arguments.assignments) {
    values = merged(std::move(values), to_change(assignment));
  }
  with_settings({}, values);  // throws an error that names a wrong key
  write_file(arguments.file, values.dump(2) + "\n", for_all_to_read);
}

}  // namespace octurn
