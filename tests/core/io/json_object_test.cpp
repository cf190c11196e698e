#include "octurn/json_object.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "octurn/error.hpp"
#include "support/nested_json.hpp"
#include "support/small_stack.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json parsed_text(const std::string& text) {
  return parse_json(text, ErrorCode::bad_json, "the text");
}

TEST(ParseJson, TakesTheDeepestThatIsAllowed) {
  EXPECT_EQ(parsed_text(nested_arrays(32)).dump(), nested_arrays(32));
  EXPECT_EQ(parsed_text(nested_objects(32)).dump(), nested_objects(32));
}

TEST(ParseJson, RefusesOneLevelMore) {
  for (const std::string& text :
       {nested_arrays(33), nested_objects(33), R"({"a": [1, {"b": )" + nested_arrays(30) + "}]}"}) {
    const Error error = error_thrown_by([&] { parsed_text(text); });
    EXPECT_EQ(error.code(), ErrorCode::bad_json);
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
      EXPECT_EQ(code_thrown_by([&] { parsed_text(text); }), "bad-json");
    }
  });
}

TEST(ParseJson, RefusesWhatIsTooLarge) {
  const std::string whole = "[" + std::string(max_json_bytes - 2, ' ') + "]";
  EXPECT_EQ(parsed_text(whole), json::array());
  EXPECT_EQ(code_thrown_by([&] { parsed_text(whole + " "); }), "bad-json");
}

TEST(ParseJson, RefusesMoreValuesThanAreAllowed) {
  const auto parse = [](const std::string& text, std::size_t values) {
    return parse_json(text, ErrorCode::bad_json, "the text", {.values = values});
  };
  for (const char* const text : {R"([[], [], {}])", R"({"a": 1, "b": ["x"]})"}) {
    EXPECT_NO_THROW(parse(text, 4)) << text;
    const Error error = error_thrown_by([&] { parse(text, 3); });
    EXPECT_EQ(error.code(), ErrorCode::bad_json);
    EXPECT_STREQ(error.what(), "the text has more than 3 values");
  }
}

TEST(ParseJson, BoundsTheMemoryOfAnyText) {
  std::string many = "[[]";
  while (many.size() + 4 < max_json_bytes) {
    many += ",[]";
  }
  EXPECT_STREQ(error_thrown_by([&] { parsed_text(many + "]"); }).what(),
               "the text has more than 1000000 values");
}

TEST(ParseJson, RefusesWhatIsNoJson) {
  for (const char* const text : {"", "{", "[1,]", "nan", "\xff", "[] []"}) {
    EXPECT_STREQ(error_thrown_by([&] { parsed_text(text); }).what(), "the text is not JSON")
        << text;
  }
}

/// The part of a refusal's message that quotes the refused value.
std::string refused_text(const json& value) {
  const Error error = error_thrown_by([&] {
    const json object{{"key", value}};
    JsonObject(object, ErrorCode::bad_json, "").refuse("key", value, "right");
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
    const Error error = error_thrown_by(
        [&] { JsonObject(object, ErrorCode::bad_json, "").refuse("key", deep, "shallow"); });
    EXPECT_STREQ(error.what(), R"("key" is [[...]]: must be shallow)");
  });
}

/// The message with which `read` refuses the JSON of `text`.
template <typename Read>
std::string refusal(const char* text, const Read& read) {
  const json document = parsed_text(text);
  return error_thrown_by([&] {
           JsonObject keys(document, ErrorCode::bad_json, "");
           read(keys);
         })
      .what();
}

TEST(JsonObject, ReadsEachKindOfValue) {
  const json document =
      parsed_text(R"({"n": 2.5, "w": -3, "f": true, "t": "é", "a": [1, 2], "o": {"k": 7}})");
  JsonObject keys(document, ErrorCode::bad_json, "");
  EXPECT_EQ(keys.at("n").number(2.5, 2.5), 2.5);
  EXPECT_EQ(keys.at("w").whole_number(-3, -3), -3);
  EXPECT_EQ(keys.at("w").number(), -3.0);
  EXPECT_TRUE(keys.at("f").flag());
  EXPECT_EQ(keys.at("t").text(), "é");
  EXPECT_EQ(keys.at("a").elements().at(1).whole_number(0, 9), 2);
  EXPECT_EQ(keys.number("n", 0, 9), 2.5);
  EXPECT_EQ(keys.text("none"), std::nullopt);
  EXPECT_FALSE(keys.value("none"));
  JsonObject inner(keys.at("o"));
  EXPECT_EQ(inner.whole_number("k", 7, 7), 7);
  EXPECT_NO_THROW(keys.refuse_unread());
}

TEST(JsonObject, NamesTheKeyThatIsMissingByWhereItStands) {
  EXPECT_EQ(refusal("{}", [](JsonObject& keys) { keys.at("port"); }), "\"port\" is missing");
  EXPECT_EQ(refusal(R"({"a": {"b": [{}]}})",
                    [](JsonObject& keys) {
                      JsonObject inner(keys.at("a"));
                      JsonObject(inner.at("b").elements().at(0)).at("c");
                    }),
            "\"a.b[0].c\" is missing");
}

TEST(JsonObject, SaysWhatAValueMustBe) {
  const char* const text = R"({"k": [0, "x"], "o": {"n": 1.5}})";
  const auto on_array = [&](const auto& read) {
    return refusal(text, [&](JsonObject& keys) { read(keys.at("k")); });
  };
  EXPECT_EQ(on_array([](const JsonValue& k) { k.number(); }),
            R"("k" is [0,"x"]: must be a number)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.text(); }), R"("k" is [0,"x"]: must be text)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.flag(); }),
            R"("k" is [0,"x"]: must be true or false)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.elements(3); }),
            R"("k" is [0,"x"]: must be an array of 3)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.elements().at(1).number(1, 2); }),
            R"("k[1]" is "x": must be a number from 1 to 2)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.elements().at(1).number(1767225600, 4102444800); }),
            R"("k[1]" is "x": must be a number from 1767225600 to 4102444800)");
  EXPECT_EQ(on_array([](const JsonValue& k) { k.elements().at(0).whole_number(1, 2); }),
            R"("k[0]" is 0: must be a whole number from 1 to 2)");
  EXPECT_EQ(on_array([](const JsonValue& k) { JsonObject object(k); }),
            R"("k" is [0,"x"]: must be an object)");
  EXPECT_EQ(
      refusal(text, [](JsonObject& keys) { JsonObject(keys.at("o")).at("n").whole_number(1, 2); }),
      R"("o.n" is 1.5: must be a whole number from 1 to 2)");
}

TEST(JsonObject, RefusesNumbersThatAreNone) {
  const json nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_STREQ(
      error_thrown_by([&] { JsonValue(nan, "k", ErrorCode::bad_json).number(0, 1); }).what(),
      R"("k" is nan: must be a number from 0 to 1)");
}

TEST(JsonObject, RefusesKeysThatNobodyHasRead) {
  const json document = parsed_text(R"({"port": 80, "prot": 81})");
  JsonObject keys(document, ErrorCode::bad_json, "");
  keys.at("port");
  keys.value("host");
  const Error error = error_thrown_by([&] { keys.refuse_unread(); });
  EXPECT_STREQ(error.what(), "\"prot\": unknown key");
  EXPECT_EQ(error.hint(), "The keys are: host, port.");
}

}  // namespace
}  // namespace octurn
