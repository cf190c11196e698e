#include "appliance/appliance.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// The appliance's folder as its root services create it.
class Folder {
 public:
  Folder() { fs::create_directory(requests()); }
  const fs::path& path() const { return folder_.path(); }
  fs::path requests() const { return path() / "requests"; }
  void answer(const std::string& name, std::string_view text) const { put(path() / name, text); }

 private:
  TemporaryFolder folder_;
};

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

TEST(Appliance, KnowsNothingBeforeRootHasAnswered) {
  const Folder folder;
  const Appliance appliance(folder.path());
  EXPECT_EQ(appliance.update().state, "none");
  EXPECT_EQ(appliance.update().slot, "");
  EXPECT_EQ(appliance.wifi().state, "none");
  EXPECT_TRUE(appliance.wifi().networks.empty());
  EXPECT_EQ(appliance.errors(), "");
  EXPECT_FALSE(appliance.is_updating());
}

TEST(Appliance, AsksRootToEndTheMachineOrToSetItsClock) {
  const Folder folder;
  Appliance appliance(folder.path());
  const auto asked = [&](const ControlRequest& request) {
    appliance.ask_for_control(request);
    return content_of(folder.requests() / "control");
  };
  EXPECT_EQ(asked(PowerEnd::restart), "restart\n");
  EXPECT_EQ(asked(PowerEnd::off), "off\n");
  EXPECT_EQ(asked(clock_from({{"unix_s", 1795555555.9}})), "clock 1795555555\n");
}

TEST(Appliance, IsGivenATimeOfThisCentury) {
  for (const nlohmann::json& body :
       std::vector<nlohmann::json>{nlohmann::json::object(),
                                   {{"unix_s", 0}},
                                   {{"unix_s", 5e9}},
                                   {{"unix_s", "now"}},
                                   {{"unix_s", 1795555555}, {"zone", "UTC"}}}) {
    EXPECT_EQ(code_thrown_by([&] { clock_from(body); }), "bad-settings") << body;
  }
}

TEST(Appliance, TellsWhatRootAnswered) {
  const Folder folder;
  const Appliance appliance(folder.path());
  folder.answer(
      "update",
      "slot = b\nstate = returned\nversion = 0.2.0\nerror = it did = not start\nnew = 1\n");
  EXPECT_EQ(appliance.update().slot, "b");
  EXPECT_EQ(appliance.update().state, "returned");
  EXPECT_EQ(appliance.update().version, "0.2.0");
  EXPECT_EQ(appliance.update().error, "it did = not start");
  folder.answer("wifi", "state = hotspot\r\nname=Home\n\ncountry = DE\nhotspot = Octurn-1A2B\n");
  EXPECT_EQ(appliance.wifi().state, "hotspot");
  EXPECT_EQ(appliance.wifi().name, "Home");
  EXPECT_EQ(appliance.wifi().country, "DE");
  EXPECT_EQ(appliance.wifi().hotspot, "Octurn-1A2B");
  folder.answer("networks", "bssid / ...\n02:00:00:00:00:01\t2412\t-60\t[ESS]\tHome\n");
  EXPECT_EQ(appliance.wifi().networks.size(), 1U);
  folder.answer("update", "state = dancing\n");
  EXPECT_EQ(appliance.update().state, "none");
}

TEST(Appliance, LeavesARequestForAWifiThatOnlyItsOwnerReads) {
  const Folder folder;
  Appliance appliance(folder.path());
  appliance.ask_for_wifi({.name = "Home", .password = "open sesame", .country = "DE"});
  const fs::path request = folder.requests() / "wifi";
  EXPECT_EQ(content_of(request),
            "wifi_name = Home\nwifi_password = open sesame\nwifi_country = DE\n");
  EXPECT_EQ(fs::status(request).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(Appliance, IsJoiningUntilRootHasAnswered) {
  const Folder folder;
  Appliance appliance(folder.path());
  folder.answer("wifi", "state = hotspot\nname = Old\ncountry = US\nerror = Old is away\n");
  const auto before = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(folder.path() / "wifi", before);
  appliance.ask_for_wifi({.name = "Home", .country = "DE"});
  fs::remove(folder.requests() / "wifi");
  EXPECT_EQ(appliance.wifi().state, "joining");
  EXPECT_EQ(appliance.wifi().name, "Home");
  EXPECT_EQ(appliance.wifi().country, "DE");
  EXPECT_EQ(appliance.wifi().error, "");
  fs::last_write_time(folder.path() / "wifi", before + std::chrono::hours(2));
  EXPECT_EQ(appliance.wifi().state, "hotspot");
  EXPECT_EQ(appliance.wifi().error, "Old is away");
}

TEST(Appliance, HandsAnUpdateOverWhole) {
  const Folder folder;
  Appliance appliance(folder.path());
  const fs::path request = folder.requests() / "update";
  folder.answer("update", "slot = a\nstate = failed\nerror = not signed\n");
  {
    Appliance::Upload upload(appliance, 6, UpdateAge::not_older);
    upload.write(bytes_of("bun"));
    EXPECT_EQ(appliance.update().state, "receiving");
    EXPECT_EQ(appliance.update().error, "");
    EXPECT_TRUE(appliance.is_updating());
    EXPECT_FALSE(fs::exists(request));
    upload.write(bytes_of("dle"));
    upload.commit();
  }
  EXPECT_EQ(content_of(request), "bundle");
  EXPECT_EQ(fs::status(request).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(appliance.update().state, "installing");
  EXPECT_EQ(appliance.update().slot, "a");
  folder.answer("update", "slot = a\nstate = restarting\nversion = 0.2.0\n");
  EXPECT_EQ(appliance.update().state, "restarting");
  EXPECT_TRUE(appliance.is_updating());
}

TEST(Appliance, LeavesNothingOfAnUpdateThatDidNotComeWhole) {
  const Folder folder;
  Appliance appliance(folder.path());
  {
    Appliance::Upload upload(appliance, 6, UpdateAge::not_older);
    upload.write(bytes_of("bun"));
  }
  EXPECT_TRUE(fs::is_empty(folder.requests()));
  EXPECT_EQ(appliance.update().state, "none");

  put(folder.requests() / ".update.123-0", "what a killed daemon left");
  put(folder.requests() / "wifi", "wifi_name = Home\n");
  const Appliance next(folder.path());
  EXPECT_FALSE(fs::exists(folder.requests() / ".update.123-0"));
  EXPECT_TRUE(fs::exists(folder.requests() / "wifi"));
}

TEST(Appliance, TakesOneUpdateAtATime) {
  const Folder folder;
  Appliance appliance(folder.path());
  const auto try_one = [&] {
    return code_thrown_by([&] { Appliance::Upload(appliance, 1, UpdateAge::not_older); });
  };
  {
    const Appliance::Upload first(appliance, 6, UpdateAge::not_older);
    EXPECT_EQ(try_one(), "busy");
    EXPECT_EQ(appliance.update().state, "receiving");
  }
  for (const char* const state : {"installing", "restarting", "trial"}) {
    folder.answer("update", std::string("state = ") + state + "\n");
    EXPECT_EQ(try_one(), "busy") << state;
    EXPECT_EQ(appliance.update().state, state);
  }
  folder.answer("update", "state = failed\n");
  const Appliance::Upload again(appliance, 1, UpdateAge::not_older);
}

TEST(Appliance, RefusesAnUpdateThatHasNoRoom) {
  const Folder folder;
  Appliance appliance(folder.path());
  const std::uint64_t most = Appliance::Upload::max_bytes;
  EXPECT_EQ(code_thrown_by([&] { Appliance::Upload(appliance, most + 1, UpdateAge::not_older); }),
            "too-large");
  const Appliance::Upload largest(appliance, most, UpdateAge::not_older);
}

TEST(Appliance, TellsTheNewestOfManyErrors) {
  const Folder folder;
  const Appliance appliance(folder.path());
  folder.answer("kept", std::string(1U << 20U, 'x') + "the newest\n");
  fs::create_symlink(folder.path() / "kept", folder.path() / "errors");
  EXPECT_TRUE(appliance.errors().ends_with("xthe newest\n"));
  EXPECT_LE(appliance.errors().size(), std::size_t{256} << 10U);
}

}  // namespace
}  // namespace octurn
