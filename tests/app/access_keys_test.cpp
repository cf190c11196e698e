#include "http/access_keys.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "support/small_stack.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

const std::chrono::system_clock::time_point start{};

class AccessKeysTest : public ::testing::Test {
 protected:
  fs::path file() const { return folder_.path() / "keys.json"; }

  /// The status with which a request with a key is refused; 200 if it is accepted.
  int status(const std::string& key, const std::string& method, const std::string& path) const {
    const auto refused = refuse_key(keys_, {.method = method, .path = path}, key);
    return refused ? refused->status : 200;
  }

  TemporaryFolder folder_ = {};
  AccessKeys keys_{file()};
};

TEST_F(AccessKeysTest, LetInWhoeverHasOne) {
  const std::string reader = keys_.add("Home Assistant", KeyAccess::read, start).key;
  const std::string writer = keys_.add("A script", KeyAccess::full, start).key;
  EXPECT_EQ(keys_.access(reader), KeyAccess::read);
  EXPECT_EQ(keys_.access(writer), KeyAccess::full);
  EXPECT_EQ(keys_.all()[0].name, "Home Assistant");
  EXPECT_EQ(keys_.all()[0].created, "1970-01-01T00:00:00Z");
}

TEST_F(AccessKeysTest, AreCheckedOnTheStackOfAServersThread) {
  const std::string key = keys_.add("", KeyAccess::full, start).key;
  run_on_small_stack([&] { EXPECT_TRUE(keys_.access(key)); });
}

TEST_F(AccessKeysTest, AreNoneIfAnyCharacterIsWrong) {
  const std::string key = keys_.add("", KeyAccess::full, start).key;
  for (std::size_t i = 0; i < key.size(); ++i) {
    std::string other = key;
    other[i] = other[i] == '0' ? '1' : '0';
    EXPECT_FALSE(keys_.access(other)) << other;
    EXPECT_FALSE(keys_.access(key.substr(0, i))) << i;
  }
  EXPECT_FALSE(keys_.access(key + "0"));
}

TEST_F(AccessKeysTest, CountUntilTheyAreRevoked) {
  const auto first = keys_.add("", KeyAccess::full, start);
  const auto second = keys_.add("", KeyAccess::full, start);
  EXPECT_TRUE(keys_.revoke(first.kept.id));
  EXPECT_FALSE(keys_.revoke(first.kept.id));
  EXPECT_FALSE(keys_.access(first.key));
  EXPECT_TRUE(keys_.access(second.key));
  EXPECT_FALSE(AccessKeys(file()).access(first.key));
}

TEST_F(AccessKeysTest, AreKeptWithoutTheKeyInAFileOfTheirOwnersAlone) {
  const auto made = keys_.add("Home", KeyAccess::read, start);
  EXPECT_EQ(AccessKeys(file()).access(made.key), KeyAccess::read);
  EXPECT_EQ(fs::status(file()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const std::string secret = made.key.substr(made.key.rfind('-') + 1);
  EXPECT_EQ(secret.size(), 32U);
  EXPECT_EQ(content_of(file()).find(secret), std::string::npos);
  EXPECT_NE(content_of(file()).find(R"("hash": "$5$)"), std::string::npos) << "SHA-256 of crypt(5)";
}

TEST_F(AccessKeysTest, AreNoneInAFileThatIsMalformed) {
  const auto made = keys_.add("", KeyAccess::full, start);
  const std::string whole = content_of(file());
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    put(file(), whole.substr(0, size));
    EXPECT_FALSE(AccessKeys(file()).access(made.key)) << size;
  }
  for (
      const char* const text :
      {"[]", "{}", R"({"keys": 1})", R"({"keys": [{"id": 1}]})",
       R"({"keys": [{"id": "00000000", "name": "", "access": "all", "created": "", "hash": ""}]})"}) {
    put(file(), text);
    EXPECT_TRUE(AccessKeys(file()).all().empty()) << text;
  }
  put(file(), R"({"keys": [{"id": ")" + made.kept.id +
                  R"(", "name": "", "access": "full", "created": "", "hash": ""}]})");
  EXPECT_FALSE(AccessKeys(file()).access(made.key));
}

TEST_F(AccessKeysTest, AreNotWithoutNumber) {
  for (std::size_t i = 0; i < AccessKeys::max_keys; ++i) {
    keys_.add("", KeyAccess::read, start);
  }
  EXPECT_EQ(code_thrown_by([&] { keys_.add("", KeyAccess::read, start); }), "bad-settings");
}

TEST_F(AccessKeysTest, ForReadingChangeNothing) {
  const std::string key = keys_.add("", KeyAccess::read, start).key;
  EXPECT_EQ(status(key, "GET", "/api/v1/status"), 200);
  EXPECT_EQ(status(key, "HEAD", "/Scan.stl"), 200);
  for (const char* const method : {"POST", "PUT", "PATCH", "DELETE", "OPTIONS", "get", ""}) {
    EXPECT_EQ(status(key, method, "/api/v1/scans"), 403) << method;
  }
}

TEST_F(AccessKeysTest, NeverSayWhoMayUseTheScanner) {
  const std::string key = keys_.add("", KeyAccess::full, start).key;
  EXPECT_EQ(status(key, "POST", "/api/v1/scans"), 200);
  EXPECT_EQ(status(key, "PUT", "/api/v1/settings/password"), 403);
  for (const char* const method : {"GET", "POST", "DELETE"}) {
    EXPECT_EQ(status(key, method, "/api/v1/keys"), 403) << method;
    EXPECT_EQ(status(key, method, "/api/v1/keys/00000000"), 403) << method;
  }
  EXPECT_EQ(status("octurn-00000000-0", "GET", "/api/v1/status"), 401);
}

TEST_F(AccessKeysTest, AreReadFromTheHeaderOfTheirScheme) {
  const auto key = [](const std::string& header) {
    const Request request{.headers = {{"authorization", header}}};
    return std::string(key_in(request).value_or("none"));
  };
  EXPECT_EQ(key("Bearer octurn-1-2"), "octurn-1-2");
  EXPECT_EQ(key("bearer x"), "x");
  EXPECT_EQ(key("Bearer "), "");
  EXPECT_EQ(key("Bearer"), "none");
  EXPECT_EQ(key("Digest username=\"octurn\""), "none");
  EXPECT_FALSE(key_in(Request{}));
}

}  // namespace
}  // namespace octurn
