#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "appliance/wifi.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

json home() { return {{"name", "Home"}, {"password", "open sesame"}, {"country", "DE"}}; }

json home_with(const char* key, const json& value) {
  json body = home();
  body[key] = value;
  return body;
}

TEST(WifiRequest, IsWrittenAsOcturnTxtHasIt) {
  EXPECT_EQ(to_text(wifi_request_from(home())),
            "wifi_name = Home\nwifi_password = open sesame\nwifi_country = DE\n");
  EXPECT_EQ(to_text(wifi_request_from({{"name", "Caf\xc3\xa9 # = 1"}, {"country", "gb"}})),
            "wifi_name = Caf\xc3\xa9 # = 1\nwifi_country = GB\n");
}

TEST(WifiRequest, TakesWhatWpaTakes) {
  for (const std::string& password :
       {std::string(8, 'a'), std::string(63, '~'), std::string(64, 'F'), std::string("12 45 78")}) {
    EXPECT_EQ(wifi_request_from(home_with("password", password)).password, password);
  }
  EXPECT_EQ(wifi_request_from(home_with("name", std::string(32, 'n'))).name.size(), 32U);
}

TEST(WifiRequest, RefusesWhatCannotBeJoined) {
  for (const json& name : std::vector<json>{"", std::string(33, 'n'), " Home", "Home ", "a\nb",
                                            "a\rb", std::string("a\0b", 3), 5, nullptr}) {
    EXPECT_EQ(code_thrown_by([&] { wifi_request_from(home_with("name", name)); }), "bad-wifi")
        << name;
  }
  for (const json& country : std::vector<json>{"", "D", "DEU", "D1", "\xc3\xa4", 49, nullptr}) {
    EXPECT_EQ(code_thrown_by([&] { wifi_request_from(home_with("country", country)); }), "bad-wifi")
        << country;
  }
  EXPECT_EQ(code_thrown_by([] { wifi_request_from({{"name", "Home"}}); }), "bad-wifi");
  EXPECT_EQ(code_thrown_by([] { wifi_request_from({{"country", "DE"}}); }), "bad-wifi");
  EXPECT_EQ(code_thrown_by([] { wifi_request_from(home_with("channel", 6)); }), "bad-wifi");
}

TEST(WifiRequest, RefusesAPasswordThatIsNoneAndDoesNotRepeatIt) {
  for (const json& password : std::vector<json>{
           "", "s3cret7", std::string(63, 's') + "3c", std::string(64, 's'), "s3cret\xc3\xa9s3cret",
           "s3cret\ns3cret", " s3cret s3cret", "s3cret s3cret ", "********", 12345678, nullptr}) {
    const Error error =
        error_thrown_by([&] { wifi_request_from(home_with("password", password)); });
    EXPECT_EQ(error.code(), ErrorCode::bad_wifi) << password;
    EXPECT_EQ((error.what() + error.hint()).find("s3c"), std::string::npos) << error.what();
    EXPECT_EQ((error.what() + error.hint()).find("12345678"), std::string::npos) << error.what();
    EXPECT_FALSE(error.hint().empty());
  }
}

}  // namespace
}  // namespace octurn
