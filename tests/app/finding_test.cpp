#include "doctor/finding.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "version.hpp"

namespace octurn {
namespace {

constexpr Check speed{"speed", "Speed"};

TEST(Finding, OfAWholeIsItsWorst) {
  EXPECT_EQ(overall_state(std::vector{speed.ok("1"), speed.unknown("?")}), Finding::State::ok);
  EXPECT_EQ(overall_state(std::vector{speed.warning("2", "Wait."), speed.ok("1")}),
            Finding::State::warning);
  EXPECT_EQ(overall_state(std::vector{speed.warning("2", "Wait."), speed.fault("3", "Run.")}),
            Finding::State::fault);
}

TEST(Finding, IsJsonThatStandsAlone) {
  const auto json =
      to_json(std::vector{speed.fault("3 km/h", "Run.", Action::set_pose), speed.unknown("?")});
  EXPECT_EQ(json["version"], version());
  EXPECT_EQ(json["state"], "fault");
  EXPECT_TRUE(std::regex_match(json["time"].get<std::string>(),
                               std::regex(R"(20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
  ASSERT_EQ(json["findings"].size(), 2);
  EXPECT_EQ(json["findings"][0], nlohmann::json({{"check", "speed"},
                                                 {"name", "Speed"},
                                                 {"state", "fault"},
                                                 {"measured", "3 km/h"},
                                                 {"advice", "Run."},
                                                 {"action", "set-pose"}}));
  EXPECT_EQ(json["findings"][1]["action"], "");
  EXPECT_EQ(json["findings"][1]["state"], "unknown");
}

TEST(Finding, HasNumbersWithoutMoreDigitsThanItSays) {
  EXPECT_EQ(rounded(-25.04, 1), "-25.0");
  EXPECT_EQ(rounded(0.96, 1), "1.0");
  EXPECT_EQ(rounded(-0.04, 1), "0.0");
}

TEST(Finding, HasSizesAsPeopleReadThem) {
  EXPECT_EQ(readable_bytes(512e6), "512 MB");
  EXPECT_EQ(readable_bytes(2.46e9), "2.5 GB");
}

}  // namespace
}  // namespace octurn
