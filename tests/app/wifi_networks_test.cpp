#include <gtest/gtest.h>

#include "appliance/wifi.hpp"

namespace octurn {
namespace {

// The header line of wpa_cli 2.10.
const std::string head = "bssid / frequency / signal level / flags / ssid\n";

std::string line(const std::string& name, int signal_dbm = -60,
                 const std::string& flags = "[WPA2-PSK-CCMP][ESS]") {
  return "02:00:00:00:00:01\t2412\t" + std::to_string(signal_dbm) + "\t" + flags + "\t" + name +
         "\n";
}

/// The networks' names in a table, separated by commas.
std::string names(const std::string& lines) {
  std::string names;
  for (const WifiNetwork& network : wifi_networks(head + lines)) {
    names += (names.empty() ? "" : ",") + network.name;
  }
  return names;
}

TEST(WifiNetworks, TellNameSignalAndWhetherThereIsAPassword) {
  const auto networks =
      wifi_networks(head + line("Home", -48) + line("Guests", -71, "[ESS]") +
                    line("Old", -80, "[WEP][ESS]") + line("New", -81, "[RSN-SAE-CCMP][ESS]"));
  ASSERT_EQ(networks.size(), 4U);
  EXPECT_EQ(networks[0].name, "Home");
  EXPECT_EQ(networks[0].signal_dbm, -48);
  EXPECT_TRUE(networks[0].secured);
  EXPECT_FALSE(networks[1].secured);
  EXPECT_TRUE(networks[2].secured);
  EXPECT_TRUE(networks[3].secured);
}

TEST(WifiNetworks, AreTheStrongestFirstAndEachOnce) {
  const auto networks =
      wifi_networks(head + line("Far", -85) + line("Home", -70, "[ESS]") + line("Home", -40));
  ASSERT_EQ(networks.size(), 2U);
  EXPECT_EQ(networks[0].name, "Home");
  EXPECT_EQ(networks[0].signal_dbm, -40);
  EXPECT_TRUE(networks[0].secured);
  EXPECT_EQ(networks[1].name, "Far");
}

TEST(WifiNetworks, AreNamedAsTheirOwnersNamedThem) {
  EXPECT_EQ(names(line(R"(Caf\xc3\xa9 \"am Eck\" a\\b)")), "Caf\xc3\xa9 \"am Eck\" a\\b");
  EXPECT_EQ(names(line("Two words")), "Two words");
  EXPECT_EQ(names(line(R"(\xf0\x9f\x8f\xa0)")), "\xf0\x9f\x8f\xa0");  // a house
}

TEST(WifiNetworks, LeaveOutNamesThatNobodyCouldChoose) {
  for (const char* const name :
       {"", R"(\x00\x00\x00)", R"(a\nb)", R"(a\x7fb)", R"(\xff\xfe)", R"(\xc3)", R"(\xc0\xaf)",
        R"(\xe0\x80\x80)", R"(\xed\xa0\x80)", R"(\xf0\x80\x80\x80)", R"(\xf4\x90\x80\x80)",
        R"(\xf5\x80\x80\x80)", R"(\x)", R"(\xg0)", R"(\q)", "\\", " blank", "blank ",
        "33 bytes are more than a name has"}) {
    EXPECT_EQ(names(line(name) + line("Home")), "Home") << name;
  }
}

TEST(WifiNetworks, AreThoseOfWholeLines) {
  EXPECT_EQ(names(""), "");
  EXPECT_TRUE(wifi_networks("").empty());
  EXPECT_EQ(names("02:00:00:00:00:01\t2412\tstrong\t[ESS]\tHome\n" + line("Work")), "Work");
  const std::string whole = line("Home");
  for (std::size_t size = 0; size < whole.find("Home"); ++size) {
    EXPECT_EQ(names(whole.substr(0, size)), "") << size;
  }
}

}  // namespace
}  // namespace octurn
