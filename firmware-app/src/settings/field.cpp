#include "settings/field.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A list in words: "a", "a or b", "a, b or c".
std::string alternatives(const json& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += i == 0 ? "" : i + 1 == values.size() ? " or " : ", ";
    text += plain_text(values[i]);
  }
  return text;
}

json number_schema(const char* type, double min, double max) {
  return {{"type", type}, {"minimum", min}, {"maximum", max}};
}

Access duration(std::chrono::milliseconds& value, std::chrono::milliseconds unit, int min,
                int max) {
  return {.read = [&value, unit, min,
                   max](const JsonValue& given) { value = given.whole_number(min, max) * unit; },
          .write = [&value, unit] { return json(value / unit); },
          .schema = number_schema("integer", min, max)};
}

}  // namespace

double rounded_mm(double metres) { return std::round(mm_from_metres(metres) * 1e6) / 1e6; }

Access number(double& value, double min, double max, const Unit& unit) {
  return {.read = [&value, min, max,
                   unit](const JsonValue& given) { value = unit.to_si(given.number(min, max)); },
          .write = [&value, unit] { return json(unit.from_si(value)); },
          .schema = number_schema("number", min, max)};
}

Access whole(int& value, int min, int max) {
  return {
      .read = [&value, min, max](const JsonValue& given) { value = given.whole_number(min, max); },
      .write = [&value] { return json(value); },
      .schema = number_schema("integer", min, max)};
}

Access whole(std::optional<int>& value, int min, int max) {
  return {.read =
              [&value, min, max](const JsonValue& given) {
                value = given.json().is_null() ? std::nullopt
                                               : std::optional(given.whole_number(min, max));
              },
          .write = [&value] { return value ? json(*value) : json(nullptr); },
          .schema = number_schema("integer", min, max)};
}

Access one_of(int& value, const std::vector<int>& allowed) {
  const json schema{{"type", "integer"}, {"enum", allowed}};
  return {.read =
              [&value, allowed, schema](const JsonValue& given) {
                const int chosen = given.whole_number(allowed.front(), allowed.back());
                if (std::ranges::find(allowed, chosen) == allowed.end()) {
                  given.refuse(allowed_text(schema));
                }
                value = chosen;
              },
          .write = [&value] { return json(value); },
          .schema = schema};
}

Access flag(bool& value) {
  return {.read = [&value](const JsonValue& given) { value = given.flag(); },
          .write = [&value] { return json(value); },
          .schema = {{"type", "boolean"}}};
}

Access text(std::string& value) {
  return {.read = [&value](const JsonValue& given) { value = given.text(); },
          .write = [&value] { return json(value); },
          .schema = {{"type", "string"}}};
}

Access texts(std::vector<std::string>& value) {
  return {.read =
              [&value](const JsonValue& given) {
                const json& names = given.json();
                const auto is_text = [](const json& one) { return one.is_string(); };
                if (!names.is_array() || !std::ranges::all_of(names, is_text)) {
                  given.refuse("an array of texts");
                }
                value = names.get<std::vector<std::string>>();
              },
          .write = [&value] { return json(value); },
          .schema = {{"type", "array"}, {"items", {{"type", "string"}}}}};
}

Access path(std::filesystem::path& value, std::size_t min_length) {
  return {.read =
              [&value, min_length](const JsonValue& given) {
                if (given.text().size() < min_length) {
                  given.refuse("a path");
                }
                value = given.text();
              },
          .write = [&value] { return json(value.string()); },
          .schema = {{"type", "string"}, {"minLength", min_length}}};
}

Access milliseconds(std::chrono::milliseconds& value, int min, int max) {
  return duration(value, std::chrono::milliseconds(1), min, max);
}

Access seconds(std::chrono::milliseconds& value, int min, int max) {
  return duration(value, std::chrono::seconds(1), min, max);
}

Access megabytes(std::size_t& bytes, double min, double max) {
  return {.read =
              [&bytes, min, max](const JsonValue& given) {
                bytes = static_cast<std::size_t>(bytes_from_mb(given.number(min, max)));
              },
          .write = [&bytes] { return json(mb_from_bytes(static_cast<double>(bytes))); },
          .schema = number_schema("number", min, max)};
}

Access object(std::vector<Field> fields, std::function<void(JsonObject&)> check) {
  const json schema = to_schema(fields);
  return {.read =
              [fields, check = std::move(check)](const JsonValue& given) {
                JsonObject keys(given);
                read_fields(keys, fields);
                check(keys);
                keys.refuse_unread();
              },
          .write = [fields = std::move(fields)] { return to_json(fields); },
          .schema = schema};
}

Access name(const std::vector<std::string_view>& names, std::function<void(std::string)> read,
            std::function<std::string_view()> write) {
  const json schema{{"type", "string"}, {"enum", names}};
  return {.read =
              [names, schema, read = std::move(read)](const JsonValue& given) {
                const bool known = given.json().is_string() &&
                                   std::ranges::find(names, given.text()) != names.end();
                if (!known) {
                  given.refuse(allowed_text(schema));
                }
                read(given.text());
              },
          .write = [write = std::move(write)] { return json(write()); },
          .schema = schema};
}

void read_fields(JsonObject& object, const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    if (const auto given = object.value(field.key)) {
      field.access.read(*given);
    }
  }
}

json to_json(const std::vector<Field>& fields) {
  json object = json::object();
  for (const Field& field : fields) {
    object[std::string(field.key)] = field.access.write();
  }
  return object;
}

json to_schema(const std::vector<Field>& fields) {
  json properties = json::object();
  for (const Field& field : fields) {
    json property = field.access.schema;
    property["description"] = field.help;
    if (!field.unit.empty()) {
      property["x-unit"] = field.unit;
    }
    if (!field.method.empty()) {
      property["x-method"] = field.method;
    }
    properties[std::string(field.key)] = std::move(property);
  }
  return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
}

std::string allowed_text(const json& schema) {
  if (schema.contains("enum")) {
    return alternatives(schema["enum"]);
  }
  if (schema.contains("minimum")) {
    return plain_text(schema["minimum"]) + " to " + plain_text(schema["maximum"]);
  }
  if (schema.contains("minItems")) {
    const std::string of_each = allowed_text(schema["items"]);
    return plain_text(schema["minItems"]) + " numbers" + (of_each.empty() ? "" : ", ") + of_each;
  }
  if (schema.contains("items") && schema["items"].contains("minItems")) {
    return "lists of " + allowed_text(schema["items"]);
  }
  return schema.value("type", "") == "boolean" ? "true or false" : "";
}

std::string plain_text(const json& value) {
  if (value.is_number()) {
    std::ostringstream text;
    text.precision(10);
    text << value.get<double>();
    return text.str();
  }
  if (!value.is_array()) {
    return value.dump();
  }
  std::string text;
  for (const json& element : value) {
    text += (text.empty() ? "" : ", ") + plain_text(element);
  }
  return "[" + text + "]";
}

std::string whole_mb_text(std::uint64_t bytes) {
  const double mb = mb_from_bytes(static_cast<double>(bytes));
  return std::to_string(static_cast<std::uint64_t>(mb)) + " MB";
}

std::string to_markdown(const std::vector<Field>& fields) {
  std::string table = "| key | unit | default | allowed | |\n|---|---|---|---|---|\n";
  for (const Field& field : fields) {
    const json value = field.access.write();
    const std::string usual = !field.default_text.empty() ? std::string(field.default_text)
                              : value.is_object()         ? ""
                                                          : "`" + plain_text(value) + "`";
    table += "| `" + std::string(field.key) + "` | " + std::string(field.unit) + " | " + usual +
             " | " + allowed_text(field.access.schema) + " | " +
             (field.method.empty() ? "" : std::string(field.method) + ": ") +
             std::string(field.help) + " |\n";
  }
  return table;
}

}  // namespace octurn
