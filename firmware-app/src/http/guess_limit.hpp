#pragma once

#include <chrono>
#include <map>
#include <string>

namespace octurn {

/// Slows down the guessing of passwords: an address has ten wrong guesses at once, and then one in
/// ten seconds. All addresses together have a hundred, and then one a second; those that knew the
/// password before are not among them, so that guesses from other addresses lock none of
/// them out.
///
/// Not thread-safe. The time is a parameter, so that tests need no clock.
class GuessLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr int free_guesses = 10;
  static constexpr std::chrono::seconds guess_price{10};
  static constexpr int free_guesses_of_all = 100;
  static constexpr std::chrono::seconds guess_price_of_all{1};

  /// How long a client has to wait before its next guess; 0: it may guess.
  std::chrono::seconds to_wait(const std::string& address, Time now) const;

  /// Counts a wrong guess. All addresses of one IPv6 network count as one client.
  void count_wrong(const std::string& address, Time now);

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
