#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "http/guess_limit.hpp"
#include "http/message.hpp"
#include "http/password_file.hpp"

namespace octurn {

/// Who reads an answer: a person in a browser that loads a page, or a script or another program.
enum class Reader { person, program };

/// The parts of a request that the login needs.
struct LoginAttempt {
  std::string method = "GET";
  std::string target = "/";                            ///< as it was sent, with the query
  std::string address = {};                            ///< of the client
  std::optional<std::string_view> authorization = {};  ///< the header of that name
  Reader reader = Reader::program;
};

/// Authenticates clients by the page's password and HTTP Digest (RFC 7616). A proof is valid for
/// one request with its method and target, once, and for some minutes after its challenge, so that
/// an overheard proof is useless. Wrong guesses are slowed down, but not those of a session that
/// has proved the password: a client stays in its session by the nonces that answer its proofs.
/// Whoever overhears its proofs can test guesses without the server, so limiting these would only
/// let others lock the session out. For the same reason an outdated proof starts such a session.
///
/// Thread-safe. The time is a parameter, so that tests need no clock.
class Login {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Nonces are valid in their period and in the next one.
  static constexpr std::chrono::minutes period{5};

  /// The files are of `write_password_file`, and looked for at each request: a password is valid as
  /// soon as it is set, and removed. If a file is malformed, or `password_file` is missing, nobody
  /// is admitted.
  /// @param password_file  that a person configured; empty: none
  /// @param own_file       that the page writes; overrides the other while it exists; empty: none
  explicit Login(std::filesystem::path password_file, std::filesystem::path own_file = {});

  /// Nothing if the request is admitted, as all are without a password; else its answer: 401 with a
  /// challenge, or 429 while too many wrong guesses come.
  std::optional<Response> refusal(const LoginAttempt& attempt, Time now);

 private:
  enum class Freshness { fresh, stale };

  std::filesystem::path file_in_force() const;
  bool is_own(const std::string& nonce) const;
  bool is_first_use(const DigestProof& proof, std::int64_t now);
  std::string make_nonce(const std::string& session, std::int64_t now);
  std::string sign(const std::string& text) const;
  void count_wrong(const std::string& address, Time now);
  Response challenge(const std::string& session, Freshness proof, std::int64_t now);

  const std::filesystem::path password_file_;
  const std::filesystem::path own_file_;
  std::mutex mutex_ = {};  // guards what follows
  std::string secret_;     // key that signs nonces
  std::uint64_t nonces_ = 0;
  std::optional<std::string> hash_ = {};  // of the password that was in force last
  std::map<std::int64_t, std::set<std::string>> used_ = {};  // used responses by nonce period
  GuessLimit guesses_ = {};
};

}  // namespace octurn
