#include "octurn/json_object.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "octurn/error.hpp"
#include "support/nested_json.hpp"
#include "support/small_stack.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json parsed_text(const std::string& text) { return parse_json(text, "bad-text", "the text"); }

TEST(ParseJson, TakesTheDeepestThatIsAllowed) {
  EXPECT_EQ(parsed_text(nested_arrays(32)).dump(), nested_arrays(32));
  EXPECT_EQ(parsed_text(nested_objects(32)).dump(), nested_objects(32));
}

TEST(ParseJson, RefusesOneLevelMore) {
  for (const std::string& text :
       {nested_arrays(33), nested_objects(33), R"({"a": [1, {"b": )" + nested_arrays(30) + "}]}"}) {
    const Error error = error_thrown_by([&] { parsed_text(text); });
    EXPECT_EQ(error.code(), "bad-text");
    EXPECT_STREQ(error.what(), "the text is nested more than 32 deep");
  }
}

TEST(ParseJson, CountsDepthAndNotElements) {
  std::string row = "[[]";
  for (int i = 0; i < 1000; ++i) {
    row += ",[{}]";
  }
  EXPECT_EQ(parsed_text(row + "]").size(), 1001U);
}

TEST(ParseJson, RefusesAnyDepthOnASmallStack) {
  run_on_small_stack([] {
    for (const std::string& text : {nested_arrays(600), nested_objects(600), nested_arrays(500'000),
                                    nested_objects(500'000), std::string(1'000'000, '[')}) {
      EXPECT_EQ(code_thrown_by([&] { parsed_text(text); }), "bad-text");
    }
  });
}

TEST(ParseJson, RefusesWhatIsTooLarge) {
  const std::string whole = "[" + std::string(max_json_bytes - 2, ' ') + "]";
  EXPECT_EQ(parsed_text(whole), json::array());
  EXPECT_EQ(code_thrown_by([&] { parsed_text(whole + " "); }), "bad-text");
}

TEST(ParseJson, RefusesWhatIsNoJson) {
  for (const char* const text : {"", "{", "[1,]", "nan", "\xff", "[] []"}) {
    EXPECT_STREQ(error_thrown_by([&] { parsed_text(text); }).what(), "the text is not JSON")
        << text;
  }
}

/// What the refusal of a value shows of it.
std::string refused_text(const json& value) {
  const Error error = error_thrown_by([&] {
    const json object{{"key", value}};
    JsonObject(object, "bad-text", "").refuse("key", value, "right");
  });
  const std::string message = error.what();
  const std::string begin = "\"key\" is ";
  const std::string end = ": must be right";
  EXPECT_TRUE(message.starts_with(begin) && message.ends_with(end)) << message;
  return message.substr(begin.size(), message.size() - begin.size() - end.size());
}

TEST(JsonObject, QuotesTheBeginningOfAValue) {
  EXPECT_EQ(refused_text(7), "7");
  EXPECT_EQ(refused_text("d\xc3\xa9j\xc3\xa0"), R"("d\u00e9j\u00e0")");
  EXPECT_EQ(refused_text(json::array({1, "a", json::array({2}), json::array()})),
            R"([1,"a",[...],[]])");
  EXPECT_EQ(refused_text({{"a", {{"b", 1}}}}), R"({"a":{...}})");
  EXPECT_EQ(refused_text(std::string(100, 'x')), '"' + std::string(59, 'x') + "...");
  EXPECT_EQ(refused_text(json(std::vector<int>(100, 1))).size(), 63U);
}

TEST(JsonObject, QuotesADeepValueOnASmallStack) {
  json deep = json::array();
  for (int level = 0; level < 100'000; ++level) {
    deep = json::array({std::move(deep)});
  }
  run_on_small_stack([&] {
    const json object = json::object();
    const Error error =
        error_thrown_by([&] { JsonObject(object, "bad-text", "").refuse("key", deep, "shallow"); });
    EXPECT_STREQ(error.what(), R"("key" is [[...]]: must be shallow)");
  });
}

}  // namespace
}  // namespace octurn
