#pragma once

#include <chrono>
#include <map>
#include <string>

namespace octurn {

/// Slows down the guessing of passwords: an address has ten wrong guesses at once, and then one in
/// ten seconds on average. All addresses together have a hundred, and then one a second; those that
/// knew the password before are not among them, so that guesses from other addresses lock none of
/// them out.
///
/// When the next guess is allowed is random, with no memory (a Poisson process): nobody can foresee
/// the moment and take each of them, so that a try of somebody else at the same address is allowed
/// as often as one of the guesser's. Beside R guesses a second that is a chance of at least one in
/// 20 R; no scheme could give more than one in 10 R, as it cannot tell a right password from others
/// before it has looked.
///
/// Not thread-safe. Time and chance are parameters, so that tests need no clock.
class GuessLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr int free_guesses = 10;
  static constexpr std::chrono::seconds guess_price{10};
  static constexpr int free_guesses_of_all = 100;
  static constexpr std::chrono::seconds guess_price_of_all{1};

  /// Whether a client may guess now.
  bool allows(const std::string& address, Time now) const;

  /// Counts a wrong guess. All addresses of one IPv6 network count as one client.
  /// @param chance  random and secret, exponentially distributed with a mean of 1
  void count_wrong(const std::string& address, Time now, double chance);

  /// Remembers a session and an address that knew the password. Wrong guesses of the address still
  /// count: they may be those of others behind the same proxy.
  void remember(const std::string& session, const std::string& address, Time now);

  /// Whether a session knew the password.
  bool knows(const std::string& session) const { return sessions_.contains(session); }

  /// Forgets all who knew the password: it has changed.
  void forget_known();

 private:
  std::map<std::string, Time> expiry_ = {};    // when all wrong guesses of a client expire (GCRA)
  Time expiry_of_all_ = {};                    // the same for all unknown clients
  std::map<std::string, Time> known_ = {};     // clients that knew the password, and when
  std::map<std::string, Time> sessions_ = {};  // the same for sessions
};

}  // namespace octurn
