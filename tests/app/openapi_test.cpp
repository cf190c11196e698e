// The OpenAPI description of the HTTP interface.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "http/api.hpp"
#include "octurn/file.hpp"
#include "settings/field.hpp"
#include "settings/scan_settings.hpp"
#include "store/job.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json description() {
  const std::filesystem::path file = std::filesystem::path(OCTURN_SOURCE) / "web" / "openapi.json";
  return json::parse(read_regular_file(file, 1U << 20U).value());
}

/// The described operations, such as "GET /api/v1/scans".
std::set<std::string> described(const json& paths) {
  std::set<std::string> all;
  for (const auto& [path, item] : paths.items()) {
    for (const auto& [key, operation] : item.items()) {
      if (key != "parameters") {
        std::string method = key;
        std::ranges::transform(method, method.begin(),
                               [](unsigned char c) { return std::toupper(c); });
        all.insert(method + " " + path);
      }
    }
  }
  return all;
}

/// Collects the components that a value refers to.
void collect_references(const json& value, std::set<std::string>& references) {
  if (value.is_object() && value.contains("$ref")) {
    references.insert(value.at("$ref").get<std::string>());
  }
  if (value.is_structured()) {
    for (const json& part : value) {
      collect_references(part, references);
    }
  }
}

TEST(OpenApi, DescribesEveryRouteAndNoOther) {
  std::set<std::string> routes;
  for (const RouteName& route : Api::routes()) {
    routes.insert(std::string(route.method) + " " + std::string(route.path));
  }
  EXPECT_EQ(described(description().at("paths")), routes);
}

TEST(OpenApi, NamesEachOperationOnce) {
  const json document = description();
  std::set<std::string> names;
  std::size_t operations = 0;
  for (const json& item : document.at("paths")) {
    for (const auto& [key, operation] : item.items()) {
      if (key != "parameters") {
        EXPECT_NE(operation.at("summary"), "");
        names.insert(operation.at("operationId"));
        ++operations;
      }
    }
  }
  EXPECT_EQ(names.size(), operations);
}

TEST(OpenApi, RefersToWhatItHas) {
  const json document = description();
  std::set<std::string> references;
  collect_references(document, references);
  EXPECT_FALSE(references.empty());
  for (const std::string& reference : references) {
    EXPECT_TRUE(document.contains(json::json_pointer(reference.substr(1)))) << reference;
  }
}

/// A described setting in the form of the program's schema, which does not tell what may be null.
json without_null(json setting) {
  if (setting["type"].is_array()) {
    setting["type"] = json(setting["type"][0]);
  }
  return setting;
}

void expect_settings(const std::string& name, const json& schema) {
  const json described = description().at("components").at("schemas").at(name);
  for (const auto& [key, setting] : schema.at("properties").items()) {
    if (described["properties"][key].contains("oneOf")) {
      continue;  // a pose or null
    }
    EXPECT_EQ(without_null(described["properties"][key]), setting)
        << "components.schemas." << name << " of web/openapi.json differs: " << key;
  }
}

TEST(OpenApi, HasTheSettingsOfTheProgram) {
  ScanSettings scan;
  expect_settings("ScanSettings", to_schema(fields(scan)));
  BuildSettings build;
  expect_settings("BuildSettings", to_schema(fields(build)));
}

TEST(OpenApi, KnowsEveryErrorCode) {
  const json codes = description()
                         .at("components")
                         .at("schemas")
                         .at("Problem")
                         .at("properties")
                         .at("code")
                         .at("enum");
  for (int code = 0; code <= static_cast<int>(ErrorCode::unknown); ++code) {
    const std::string word(to_string(static_cast<ErrorCode>(code)));
    EXPECT_EQ(std::ranges::count(codes, json(word)), 1) << word;
  }
}

}  // namespace
}  // namespace octurn
