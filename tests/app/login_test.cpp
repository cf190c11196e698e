#include "http/login.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "http/password_file.hpp"
#include "support/digest_client.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

const Login::Time start = Login::Time{} + 1000h;

/// A login with the password "open sesame", seen from its clients.
class LoginTest : public ::testing::Test {
 protected:
  LoginTest() { write_password_file(file(), "open sesame"); }

  std::filesystem::path file() const { return folder_.path() / "password"; }

  /// A nonce from the challenge that a client gets.
  std::string nonce(Login::Time now = start) {
    const auto answer = login_.refusal({}, now);
    return quoted_field(challenge_of(answer), "nonce");
  }

  /// The status for a request with this Authorization header; 200 if it is accepted.
  int answer(const std::string& authorization, const LoginAttempt& like = {},
             Login::Time now = start) {
    LoginAttempt attempt = like;
    attempt.authorization = authorization;
    last_ = login_.refusal(attempt, now);
    return last_ ? last_->status : 200;
  }

  /// Sends wrong passwords from the address of all, until it may send no more.
  void guess_until_locked(Login::Time now = start) {
    const std::string one = nonce(now);
    for (int i = 0; i < 20 && answer(proof_of(std::to_string(i), one), {}, now) != 429; ++i) {
    }
    ASSERT_EQ(last()->status, 429);
  }

  const std::optional<Response>& last() const { return last_; }

  bool is_told_stale() const { return challenge_of(last_).find("stale=true") != std::string::npos; }

  static std::string challenge_of(const std::optional<Response>& response) {
    for (const auto& [name, value] : response ? response->headers : Headers{}) {
      if (name == "WWW-Authenticate") {
        return value;
      }
    }
    return "";
  }

 private:
  TemporaryFolder folder_ = {};
  std::optional<Response> last_ = {};
  Login login_{file()};
};

TEST_F(LoginTest, LetsInWhoKnowsThePassword) {
  EXPECT_EQ(answer(""), 401);
  const std::string one = nonce();
  EXPECT_EQ(answer(proof_of("open sesame", one)), 200);
  EXPECT_EQ(answer(proof_of("open sesame", one, {.uses = 2})), 200);
  EXPECT_EQ(answer(proof_of("sesame", one, {.uses = 3})), 401);
}

TEST_F(LoginTest, TellsAProgramWhatIsMissingAndWho) {
  ASSERT_EQ(answer("", {.target = "/api/v1/status"}), 401);
  const auto& response = last();
  EXPECT_EQ(response->headers.front(),
            (Headers::value_type{"Content-Type", "application/problem+json"}));
  const auto body = nlohmann::json::parse(std::get<std::string>(response->body));
  EXPECT_EQ(body["status"], 401);
  EXPECT_EQ(body["code"], "password-needed");
  EXPECT_EQ(body["detail"], "the page has a password");
  EXPECT_EQ(body["hint"], "The user is octurn.");
}

TEST_F(LoginTest, TakesAProofForItsOwnTargetAndMethodAlone) {
  const std::string heard = proof_of("open sesame", nonce(), {.target = "/api/v1/status"});
  EXPECT_EQ(answer(heard, {.target = "/api/v1/scans"}), 401);
  EXPECT_EQ(answer(heard, {.target = "/api/v1/status?x=1"}), 401);
  EXPECT_EQ(answer(heard, {.method = "POST", .target = "/api/v1/status"}), 401);
  EXPECT_EQ(answer(heard, {.target = "/api/v1/status"}), 200);
}

TEST_F(LoginTest, TakesAProofOnce) {
  const std::string heard = proof_of("open sesame", nonce());
  EXPECT_EQ(answer(heard), 200);
  EXPECT_EQ(answer(heard), 401);
  EXPECT_TRUE(is_told_stale());
}

TEST_F(LoginTest, TakesNoOldNonceAndSaysThatItIsOld) {
  const std::string old = nonce();
  EXPECT_EQ(answer(proof_of("open sesame", old), {}, start + 5min), 200);
  EXPECT_EQ(answer(proof_of("open sesame", old, {.uses = 2}), {}, start + 11min), 401);
  EXPECT_TRUE(is_told_stale());
  EXPECT_EQ(answer(proof_of("wrong", old, {.uses = 3}), {}, start + 11min), 401);
  EXPECT_FALSE(is_told_stale());
}

TEST_F(LoginTest, TakesNoNonceThatItDidNotMake) {
  std::string forged = nonce();
  forged[15] = forged[15] == '9' ? '8' : '9';  // changes the time in the nonce
  Login another(file());
  const std::string foreign = quoted_field(challenge_of(another.refusal({}, start)), "nonce");
  for (const std::string& other : {forged, foreign, std::string(), std::string("7ypf")}) {
    EXPECT_EQ(answer(proof_of("open sesame", other)), 401) << other;
  }
}

TEST_F(LoginTest, SlowsGuessesDownAndThoseOfOneAddressAlone) {
  const std::string one = nonce();
  const LoginAttempt thief{.address = "10.0.0.1"};
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(answer(proof_of(std::to_string(i), one), thief), 401);
  }
  EXPECT_EQ(answer(proof_of("open sesame", one), thief), 429);
  EXPECT_EQ(answer(proof_of("open sesame", one, {.uses = 2}), {.address = "10.0.0.2"}), 200);
  EXPECT_EQ(answer("", thief), 401);  // a request without a proof is no guess
  EXPECT_EQ(answer(proof_of("open sesame", one, {.uses = 3}), thief, start + 5min), 200);
}

TEST_F(LoginTest, LocksNoSessionOutByTheGuessesOfOthersBehindItsAddress) {
  const std::string one = nonce();
  EXPECT_EQ(answer(proof_of("open sesame", one)), 200);
  guess_until_locked();
  for (int i = 2; i < 20; ++i) {  // also wrong ones: whoever overheard the nonce sends them
    EXPECT_EQ(answer(proof_of("wrong", one, {.uses = i})), 401);
  }
  EXPECT_EQ(answer(proof_of("open sesame", one, {.uses = 20})), 200);
  EXPECT_EQ(answer(proof_of("wrong", nonce())), 429) << "the right one frees no guesses of others";

  // An hour later the nonce is stale, and the next one is of the same session.
  const Login::Time later = start + 1h;
  guess_until_locked(later);
  EXPECT_EQ(answer(proof_of("open sesame", one, {.uses = 21}), {}, later), 401);
  EXPECT_TRUE(is_told_stale());
  const std::string next = quoted_field(challenge_of(last()), "nonce");
  EXPECT_EQ(answer(proof_of("open sesame", next), {}, later), 200);
}

TEST_F(LoginTest, FreesNoSessionFromTheLimitThatHasNotProvedThePassword) {
  const std::string one = nonce();
  EXPECT_EQ(answer(proof_of("open sesame", one)), 200);
  std::string forged = nonce();
  forged.replace(32, 16, one, 32, 16);  // the other session's number, signed with another one
  guess_until_locked();
  EXPECT_EQ(answer(proof_of("open sesame", forged)), 429);
  EXPECT_EQ(answer(proof_of("open sesame", nonce())), 429);

  write_password_file(file(), "another one");  // who knew the old one guesses as all others do
  EXPECT_EQ(answer(proof_of("another one", one, {.uses = 2})), 429);
  EXPECT_EQ(answer(proof_of("another one", one, {.uses = 2}), {}, start + 5min), 200);
}

// Ten guesses a second, and a browser that tries again each second; by the law of chance it needs
// 200 tries on average. Its nonce becomes outdated meanwhile.
TEST_F(LoginTest, LetsTheRightPasswordInBesideAFloodFromItsAddress) {
  guess_until_locked();
  const std::string one = nonce();
  int status = 429;
  Login::Time now = start;
  for (int tries = 1; status == 429 && tries < 6000; ++tries) {
    for (int i = 0; i < 10; ++i, now += 100ms) {
      answer(proof_of("wrong", "0"), {}, now);
    }
    status = answer(proof_of("open sesame", one, {.uses = tries}), {}, now - 50ms);
  }
  if (status == 401) {
    EXPECT_TRUE(is_told_stale());
    status = answer(proof_of("open sesame", quoted_field(challenge_of(last()), "nonce")), {}, now);
  }
  EXPECT_EQ(status, 200);
}

TEST_F(LoginTest, AsksAnOutdatedProofForNoMoreLuck) {
  const std::string old = nonce();
  Login::Time later = start + 1h;
  const std::string foreign(old.size(), '0');  // as of a scanner that has started again
  for (const std::string& outdated : {old, foreign}) {
    EXPECT_EQ(answer(proof_of("open sesame", outdated), {}, later), 401);
    ASSERT_TRUE(is_told_stale());
    const std::string next = quoted_field(challenge_of(last()), "nonce");
    guess_until_locked(later + 5min);
    EXPECT_EQ(answer(proof_of("open sesame", next), {}, later + 5min), 200);
    later += 1h;
  }
}

TEST_F(LoginTest, TellsAPersonToWaitAndTriesAgainByItself) {
  guess_until_locked();
  EXPECT_NE(std::get<std::string>(last()->body).find("too-many-guesses"), std::string::npos);
  ASSERT_EQ(answer(proof_of("open sesame", nonce()), {.reader = Reader::person}), 429);
  EXPECT_EQ(last()->headers, (Headers{{"Content-Type", "text/html; charset=utf-8"},
                                      {"Refresh", "1"},
                                      {"Retry-After", "1"}}));
  EXPECT_NE(std::get<std::string>(last()->body).find("somebody is guessing"), std::string::npos);
}

TEST_F(LoginTest, LetsNobodyInWithoutAHash) {
  const std::string one = nonce();
  for (const std::string& content :
       {std::string(), std::string("octurn:Octurn:\n"), std::string("octurn:Octurn:00\n"),
        std::string("\xff\xfe\n"), std::string(100'000, 'a')}) {
    put(file(), content);
    EXPECT_EQ(answer(proof_of("open sesame", one), {.address = content.substr(0, 20)}), 401);
  }
  std::filesystem::remove(file());
  EXPECT_EQ(answer(proof_of("open sesame", one)), 401);
  EXPECT_FALSE(read_password_hash("/dev/null"));
}

TEST_F(LoginTest, TakesFilesThatApachesProgramWrote) {
  put(file(),
      "other:Octurn:0123\r\nocturn:Octurn:" + digest_hash("octurn", "Octurn", "b") + "\r\n");
  EXPECT_EQ(answer(proof_of("b", nonce())), 200);
}

TEST(LoginFiles, AreInForceWhileTheyExist) {
  const TemporaryFolder folder;
  const std::filesystem::path own = folder.path() / "own";
  Login login({}, own);
  EXPECT_FALSE(login.refusal({}, start));
  write_password_file(own, "open sesame");
  EXPECT_TRUE(login.refusal({}, start));
  std::filesystem::remove(own);
  EXPECT_FALSE(login.refusal({}, start));
  std::filesystem::create_symlink("nowhere", own);  // it cannot be read, and admits nobody
  EXPECT_TRUE(login.refusal({}, start));
}

TEST(LoginFiles, ThePagesOverridesTheConfiguredOne) {
  const TemporaryFolder folder;
  const std::filesystem::path own = folder.path() / "own";
  const std::filesystem::path configured = folder.path() / "configured";
  write_password_file(configured, "open sesame");
  Login login(configured, own);
  const auto admits = [&](const std::string& password) {
    const auto challenge = login.refusal({}, start);
    const std::string nonce = quoted_field(challenge->headers.back().second, "nonce");
    LoginAttempt attempt;
    const std::string proof = proof_of(password, nonce);
    attempt.authorization = proof;
    return !login.refusal(attempt, start);
  };
  EXPECT_TRUE(admits("open sesame"));
  write_password_file(own, "another one");
  EXPECT_FALSE(admits("open sesame"));
  EXPECT_TRUE(admits("another one"));
  std::filesystem::remove(own);
  EXPECT_TRUE(admits("open sesame"));
}

}  // namespace
}  // namespace octurn
