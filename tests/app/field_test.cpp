#include "settings/field.hpp"

#include <gtest/gtest.h>

#include "config.hpp"
#include "settings/scan_settings.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// One setting of each type.
struct Kinds {
  double length = 0.002;
  double ratio = 0.5;
  int count = 3;
  std::optional<int> level = {};
  int microsteps = 4;
  bool flag = true;
  std::string text = "a";
  std::vector<std::string> texts = {"b", "c"};
  std::filesystem::path path = "/d";
  std::chrono::milliseconds wait = std::chrono::milliseconds(5000);
  std::size_t memory_bytes = std::size_t{3} << 20U;
  DepthFilter filter = DepthFilter::average;
};

std::vector<Field> fields(Kinds& kinds) {
  return {{.key = "length_mm", .access = number(kinds.length, 1, 10, millimetres)},
          {.key = "ratio", .access = number(kinds.ratio, 0, 1)},
          {.key = "count", .access = whole(kinds.count, 1, 5)},
          {.key = "level", .access = whole(kinds.level, 0, 16)},
          {.key = "microsteps", .access = one_of(kinds.microsteps, {1, 4, 8})},
          {.key = "flag", .access = flag(kinds.flag)},
          {.key = "text", .access = text(kinds.text)},
          {.key = "texts", .access = texts(kinds.texts)},
          {.key = "path", .access = path(kinds.path, 1)},
          {.key = "wait_s", .access = seconds(kinds.wait, 1, 60)},
          {.key = "memory_mb", .access = megabytes(kinds.memory_bytes, 1, 100)},
          {.key = "filter",
           .access = choice(kinds.filter, {DepthFilter::basic, DepthFilter::average})}};
}

void read(Kinds& kinds, const json& given) {
  JsonObject keys(given, ErrorCode::bad_settings, "");
  read_fields(keys, fields(kinds));
  keys.refuse_unread();
}

const json written{{"length_mm", 2.0}, {"ratio", 0.5}, {"count", 3},       {"level", nullptr},
                   {"microsteps", 4},  {"flag", true}, {"text", "a"},      {"texts", {"b", "c"}},
                   {"path", "/d"},     {"wait_s", 5},  {"memory_mb", 3.0}, {"filter", "average"}};

TEST(Field, IsWrittenInItsUnit) {
  Kinds kinds;
  EXPECT_EQ(to_json(fields(kinds)), written);
}

TEST(Field, IsReadAsItIsWritten) {
  const json other{{"length_mm", 7.5}, {"ratio", 0.25},          {"count", 5},
                   {"level", 9},       {"microsteps", 8},        {"flag", false},
                   {"text", "x"},      {"texts", json::array()}, {"path", "/y"},
                   {"wait_s", 60},     {"memory_mb", 64.5},      {"filter", "basic"}};
  Kinds kinds;
  read(kinds, other);
  EXPECT_EQ(to_json(fields(kinds)), other);
  EXPECT_EQ(kinds.length, 0.0075);
  EXPECT_EQ(kinds.wait, std::chrono::minutes(1));
  read(kinds, written);
  EXPECT_EQ(to_json(fields(kinds)), written);
}

TEST(Field, KeepsItsValueWhereNothingIsGiven) {
  Kinds kinds;
  read(kinds, {{"count", 4}});
  json expected = written;
  expected["count"] = 4;
  EXPECT_EQ(to_json(fields(kinds)), expected);
}

TEST(Field, RefusesWhatItsSchemaRefusesAndKeepsItsValue) {
  const json wrong{{"length_mm", {0.9, 11, "2", nullptr}},
                   {"ratio", {-0.1, 1.1, true}},
                   {"count", {0, 6, 2.5, 1e300}},
                   {"level", {-1, 17, "deep"}},
                   {"microsteps", {2, 16, 1.0}},
                   {"flag", {0, "true"}},
                   {"text", {1, nullptr}},
                   {"texts", {"b", {{"b", 1}}}},
                   {"path", {"", 5}},
                   {"wait_s", {0, 61, 1.5}},
                   {"memory_mb", {0, 101}},
                   {"filter", {"average-discard", "", 1}}};
  for (const auto& [key, values] : wrong.items()) {
    for (const json& value : values) {
      Kinds kinds;
      const Error error = error_thrown_by([&, key = key] { read(kinds, {{key, value}}); });
      EXPECT_EQ(std::string(error.what()).find("\"" + key + "\" is "), 0U) << error.what();
      EXPECT_EQ(to_json(fields(kinds)), written);
    }
  }
}

TEST(Field, TellsWhatItMayBe) {
  Kinds kinds;
  std::map<std::string, std::string> allowed;
  for (const Field& field : fields(kinds)) {
    allowed[std::string(field.key)] = allowed_text(field.access.schema);
  }
  EXPECT_EQ(allowed["length_mm"], "1 to 10");
  EXPECT_EQ(allowed["microsteps"], "1, 4 or 8");
  EXPECT_EQ(allowed["filter"], "\"basic\" or \"average\"");
  EXPECT_EQ(allowed["flag"], "true or false");
  EXPECT_EQ(allowed["text"], "");
}

TEST(Field, IsDescribedForTheInterface) {
  Config config;
  const json scan = to_schema(fields(config))["properties"]["scan"];
  EXPECT_EQ(scan["additionalProperties"], false);
  const json leaf = scan["properties"]["leaf_size_mm"];
  EXPECT_EQ(leaf["type"], "number");
  EXPECT_EQ(leaf["minimum"], 0.1);
  EXPECT_EQ(leaf["x-unit"], "mm");
  EXPECT_EQ(scan["properties"]["threshold_m2"]["x-method"], "intersection");
}

/// The generated part of docs/settings.md between the comments of that name.
std::string generated_part(const std::string& document, const std::string& name) {
  const std::string begin = "<!-- settings: " + name + " -->\n";
  const std::size_t start = document.find(begin);
  EXPECT_NE(start, std::string::npos) << name;
  const std::size_t from = start + begin.size();
  return document.substr(from, document.find("<!-- end -->\n", from) - from);
}

TEST(SettingsDocument, HasTheTablesOfTheProgram) {
  Config config;
  config.limits.memory_bytes = 1;  // its default depends on the machine
  ModelSettings model;
  std::vector<Field> of_model = fields(model);
  ScanSettings scan;
  Limits limits;
  std::erase_if(of_model, [&](const Field& field) {  // what the other tables have
    const auto is_same = [&](const Field& other) { return other.key == field.key; };
    return std::ranges::any_of(fields(scan), is_same) ||
           std::ranges::any_of(fields(limits), is_same);
  });
  const std::string document = content_of(OCTURN_SOURCE "/docs/settings.md");
  const std::vector<std::pair<std::string, std::vector<Field>>> tables{
      {"octurn.json", fields(config)}, {"scan", fields(config.scan)},
      {"reconstruct", of_model},       {"turntable", fields(config.turntable)},
      {"laser", fields(config.laser)}, {"laser line", fields(config.laser.left)}};
  for (const auto& [name, fields] : tables) {
    const std::string table = to_markdown(fields);
    EXPECT_EQ(generated_part(document, name), table)
        << "docs/settings.md differs: put this table there\n"
        << table;
  }
}

}  // namespace
}  // namespace octurn
