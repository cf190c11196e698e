#pragma once

#include <chrono>
#include <map>
#include <string>

namespace octurn {

/// Slows down whoever guesses passwords: an address may be wrong ten times at once, and after that
/// once in ten seconds. Whoever is right is forgiven.
///
/// Not thread-safe. Time is given, so that tests need none.
class GuessLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr int free_guesses = 10;
  static constexpr std::chrono::seconds guess_price{10};

  /// How long a client has to wait before its next guess; 0: it may guess.
  std::chrono::seconds to_wait(const std::string& address, Time now) const;

  /// A client was wrong. Neighbours of one IPv6 network, which has addresses without end, count as
  /// one client.
  void count_wrong(const std::string& address, Time now);

  /// A client was right.
  void forgive(const std::string& address);

 private:
  std::map<std::string, Time> paid_ = {};  // when a client will have paid for all its guesses
};

}  // namespace octurn
