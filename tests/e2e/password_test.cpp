// `octurn password`, and a daemon whose page has a password.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "support/daemon.hpp"
#include "support/digest_client.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Runs `octurn password FILE` with `typed` on its standard input. @return its exit status
int give_password(const fs::path& file, const std::string& typed) {
  Program program({"/bin/sh", "-c", "printf '%s\\n' \"$1\" | \"$0\" password \"$2\"",
                   octurn_program(), typed, file.string()});
  return program.wait();
}

fs::path config_with_password(const fs::path& folder) {
  put(folder / "octurn.json", R"({"password_file": ")" + (folder / "password").string() + R"("})");
  return folder / "octurn.json";
}

TEST(PasswordCommand, WritesAFileThatOnlyItsOwnerReads) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "password";
  ASSERT_EQ(give_password(file, "open sesame"), 0);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  const std::string first = content_of(file);
  EXPECT_EQ(first.find("sesame"), std::string::npos);
  ASSERT_EQ(give_password(file, "another one"), 0);
  EXPECT_NE(content_of(file), first);
  EXPECT_EQ(content_of(file).size(), first.size());
}

TEST(PasswordCommand, RefusesNoPasswordAndKeepsTheOneThereIs) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "password";
  ASSERT_EQ(give_password(file, "open sesame"), 0);
  const std::string first = content_of(file);
  EXPECT_EQ(give_password(file, ""), 1);
  EXPECT_EQ(give_password(file, "sevenxx"), 1);
  EXPECT_EQ(content_of(file), first);
  EXPECT_EQ(give_password(folder.path() / "nowhere" / "password", "open sesame"), 1);
}

TEST(Serve, ShowsNothingWithoutThePassword) {
  const TemporaryFolder folder;
  ASSERT_EQ(give_password(folder.path() / "password", "open sesame"), 0);
  const Daemon daemon(folder.path(), {"--config", config_with_password(folder.path())});
  for (const char* const path : {"/", "/api/v1/status", "/Scan.stl", "/nowhere"}) {
    const Reply reply = daemon.get(path);
    EXPECT_EQ(reply.status, 401) << path;
    EXPECT_EQ(reply.header("WWW-Authenticate").find("Digest "), 0U) << path;
    EXPECT_EQ(reply.body.find("Octurn</title>"), std::string::npos) << path;
  }
  EXPECT_EQ(daemon.post("/api/v1/scans").status, 401);
  EXPECT_EQ(daemon.get("/", {{"Authorization", "Digest username=\"octurn\""}}).status, 401);
  EXPECT_EQ(daemon.get("/", {{"Authorization", "Basic b2N0dXJuOm9wZW4gc2VzYW1l"}}).status, 401);
}

/// A daemon with the password "open sesame", and one of its nonces.
struct LockedDaemon {
  TemporaryFolder folder = {};
  fs::path file = give("open sesame");
  Daemon daemon{folder.path(), {"--config", config_with_password(folder.path())}};
  std::string nonce = make_nonce();

  std::string make_nonce() const {
    return quoted_field(daemon.get("/").header("WWW-Authenticate"), "nonce");
  }

  fs::path give(const std::string& password) const {
    EXPECT_EQ(give_password(folder.path() / "password", password), 0);
    return folder.path() / "password";
  }

  int answer(const std::string& path, const std::string& proof,
             const std::string& method = "GET") const {
    return request(daemon.port(), method, path, method == "GET" ? "" : "{}",
                   {{"Authorization", proof}})
        .status;
  }
};

TEST(Serve, TakesAProofOfThePasswordForOneRequest) {
  const LockedDaemon locked;
  const std::string scans = "/api/v1/scans";
  const auto proof = [&](const ProvenRequest& request) {
    return proof_of("open sesame", locked.nonce, request);
  };
  const std::string heard = proof({.target = "/api/v1/status"});
  EXPECT_EQ(locked.answer(scans, heard), 401);
  EXPECT_EQ(locked.answer("/api/v1/status", heard), 200);
  EXPECT_EQ(locked.answer("/api/v1/status", heard), 401);
  const std::string cancel = proof({.method = "POST", .target = scans + "/x/cancel", .uses = 2});
  EXPECT_EQ(locked.answer(scans, cancel, "POST"), 401);
  EXPECT_EQ(locked.answer(scans + "/x/cancel", cancel, "POST"), 404);
  const std::string query = "/api/v1/scans/a%20b/Scan.stl?leaf_size_mm=1&level=%32";
  EXPECT_EQ(locked.answer(query, proof({.target = query, .uses = 3})), 404);
}

TEST(Serve, SlowsGuessesOfThePasswordDownButNotWhoKnewIt) {
  const LockedDaemon locked;
  const std::string known = locked.make_nonce();
  EXPECT_EQ(locked.answer("/", proof_of("open sesame", known)), 200);
  const auto guess = [&](int number) {
    return locked.daemon.get("/",
                             {{"Authorization", proof_of(std::to_string(number), locked.nonce)}});
  };
  int guesses = 0;
  Reply reply = guess(0);
  while (reply.status == 401) {
    ASSERT_LT(++guesses, 1000);
    reply = guess(guesses);
  }
  EXPECT_GE(guesses, 10);
  EXPECT_EQ(parsed(reply)["code"], "too-many-guesses");
  EXPECT_GT(std::stoi(reply.header("Retry-After")), 0);
  EXPECT_EQ(locked.answer("/", proof_of("open sesame", known, {.uses = 2})), 200);
}

TEST(Serve, TakesANewPasswordAtOnce) {
  const LockedDaemon locked;
  locked.give("another one");
  EXPECT_EQ(locked.answer("/", proof_of("open sesame", locked.nonce)), 401);
  EXPECT_EQ(locked.answer("/", proof_of("another one", locked.nonce, {.uses = 2})), 200);
}

TEST(Serve, ChecksAKeyAlsoWithoutAPassword) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string key =
      parsed(daemon.post("/api/v1/keys", R"({"name": "A display", "access": "read"})"))["key"];
  const auto change = [&](const Headers& headers) {
    return request(daemon.port(), "PATCH", "/api/v1/settings", R"({"scan": {"frames": 7}})",
                   headers)
        .status;
  };
  EXPECT_EQ(daemon.get("/api/v1/status", {{"Authorization", "Bearer " + key}}).status, 200);
  EXPECT_EQ(change({{"Authorization", "Bearer " + key}}), 403);
  EXPECT_EQ(change({{"Authorization", "Bearer octurn-0-0"}}), 401);
  EXPECT_EQ(change({}), 200);
}

TEST(Serve, DoesNotStartWithoutTheFileOfItsPassword) {
  const TemporaryFolder folder;
  Program program(
      Daemon::command(folder.path(), {"--config", config_with_password(folder.path())}));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.errors().find("octurn password"), std::string::npos);
}

}  // namespace
}  // namespace octurn
