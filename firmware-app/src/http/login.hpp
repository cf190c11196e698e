#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "http/digest.hpp"
#include "http/guess_limit.hpp"
#include "http/message.hpp"

namespace octurn {

/// What the login looks at of a request.
struct LoginAttempt {
  std::string method = "GET";
  std::string path = "/";                              ///< decoded
  std::string query = {};                              ///< as it was sent
  std::string address = {};                            ///< of the client
  std::optional<std::string_view> authorization = {};  ///< the header of that name
};

/// Lets in who proves to know the page's password, by HTTP Digest (RFC 7616). A proof counts for
/// one request with its method and target, once, and only for minutes after its challenge: so who
/// has heard it has nothing. Wrong guesses are slowed.
///
/// Any thread may call it. Time is given, so that tests need none.
class Login {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Nonces of a period count in it and in the next.
  static constexpr std::chrono::minutes period{5};

  /// @param password_file  as `write_password_file` makes it; read at each request, so that a new
  /// password counts at once. Without one, or in one that is malformed, nobody is let in.
  explicit Login(std::filesystem::path password_file);

  /// Nothing if the request is let in; else its answer: 401 with a challenge, or 429 for an address
  /// that has guessed wrong too often.
  std::optional<Response> refusal(const LoginAttempt& attempt, Time now);

 private:
  enum class Freshness { fresh, stale };

  bool is_fresh(const std::string& nonce, std::int64_t now);
  bool is_first_use(const DigestProof& proof, std::int64_t now);
  std::string make_nonce(std::int64_t now);
  std::string sign(const std::string& text) const;
  Response challenge(Freshness proof, std::int64_t now);

  const std::filesystem::path password_file_;
  std::mutex mutex_ = {};  // guards what follows
  std::string secret_;     // what nonces are signed with
  std::uint64_t nonces_ = 0;
  std::map<std::int64_t, std::set<std::string>> used_ = {};  // responses, by their nonces' period
  GuessLimit guesses_ = {};
};

}  // namespace octurn
