#pragma once

#include <chrono>
#include <map>
#include <string>

namespace octurn {

/// Slows down the guessing of passwords: an address has ten wrong guesses at once, and then one in
/// ten seconds. A right one resets this.
///
/// Not thread-safe. The time is a parameter, so that tests need no clock.
class GuessLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr int free_guesses = 10;
  static constexpr std::chrono::seconds guess_price{10};

  /// How long a client has to wait before its next guess; 0: it may guess.
  std::chrono::seconds to_wait(const std::string& address, Time now) const;

  /// Counts a wrong guess. All addresses of one IPv6 network count as one client.
  void count_wrong(const std::string& address, Time now);

  /// Forgets a client's wrong guesses after a right one.
  void forgive(const std::string& address);

 private:
  std::map<std::string, Time> expiry_ = {};  // when all wrong guesses of a client expire (GCRA)
};

}  // namespace octurn
