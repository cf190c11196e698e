#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/units.hpp"

namespace octurn {

/// How one setting is read from JSON and written to it, and the values that it allows.
struct Access {
  /// @throws Error  that names the value's path, if `schema` does not allow it
  std::function<void(const JsonValue&)> read = {};
  std::function<nlohmann::json()> write = {};
  nlohmann::json schema = {};  ///< JSON Schema: "type", "minimum", "maximum", "enum" and the like
};

/// One setting of a struct. The command line, JSON files, the HTTP interface and the documents are
/// all made from a list of these, so that a new setting is one new line of it.
struct Field {
  /// Key in JSON, "leaf_size_mm"; with dashes, the option of the command line.
  std::string_view key = {};
  std::string_view unit = {};  ///< for documents and help; empty: a count or a name
  std::string_view help = {};
  Access access = {};
  std::string_view method = {};  ///< the only method that uses it; empty: both
  /// The default in documents and help, where it depends on the machine or the scan.
  std::string_view default_text = {};
};

/// Linear conversion between a setting's unit and SI.
struct Unit {
  double (*to_si)(double) = [](double value) { return value; };
  double (*from_si)(double) = [](double value) { return value; };
};

/// Millimetres, rounded to the nanometre: 0.14 m is 140 mm and not 140.00000000000003.
double rounded_mm(double metres);
inline constexpr Unit millimetres{.to_si = metres_from_mm, .from_si = rounded_mm};

// Access to a member, which must outlive it. Ranges are in the setting's own unit.

Access number(double& value, double min, double max, const Unit& unit = {});
Access whole(int& value, int min, int max);
/// JSON null stands for no value.
Access whole(std::optional<int>& value, int min, int max);
Access one_of(int& value, const std::vector<int>& allowed);
Access flag(bool& value);
Access text(std::string& value);
Access texts(std::vector<std::string>& value);
/// @param min_length  1 refuses the empty path
Access path(std::filesystem::path& value, std::size_t min_length);
Access milliseconds(std::chrono::milliseconds& value, int min, int max);
Access seconds(std::chrono::milliseconds& value, int min, int max);
Access megabytes(std::size_t& bytes, double min, double max);
/// A nested object of settings. Unknown keys are refused.
/// @param check  compares settings with one another, after all were read
Access object(std::vector<Field> fields, std::function<void(JsonObject&)> check);
/// One of these names.
Access name(const std::vector<std::string_view>& names, std::function<void(std::string)> read,
            std::function<std::string_view()> write);

/// An enumerator, by its name from `to_string`.
template <typename Enum>
Access choice(Enum& value, std::initializer_list<Enum> all) {
  std::vector<std::string_view> names;
  for (const Enum one : all) {
    names.push_back(to_string(one));
  }
  const auto read = [&value, values = std::vector(all)](const std::string& chosen) {
    for (const Enum one : values) {
      if (to_string(one) == chosen) {
        value = one;
      }
    }
  };
  return name(names, read, [&value] { return to_string(value); });
}

/// Reads the settings that the object gives; the others keep their values.
/// @throws Error  that names the key, its value and what is allowed
void read_fields(JsonObject& object, const std::vector<Field>& fields);

/// A JSON object with every setting.
nlohmann::json to_json(const std::vector<Field>& fields);

/// JSON Schema of the object with these settings. "x-unit" and "x-method" hold unit and method.
nlohmann::json to_schema(const std::vector<Field>& fields);

/// The values that a schema allows, in words: "0.1 to 5000", "\"solid\" or \"intersection\"".
std::string allowed_text(const nlohmann::json& schema);

/// A value for people: 1 and not 1.0.
std::string plain_text(const nlohmann::json& value);

/// A size for people, in megabytes rounded down: "512 MB".
std::string whole_mb_text(std::uint64_t bytes);

/// Markdown table for the documents, one row for each setting.
std::string to_markdown(const std::vector<Field>& fields);

}  // namespace octurn
