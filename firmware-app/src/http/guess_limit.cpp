#include "http/guess_limit.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

namespace octurn {
namespace {

// More than a home network has. Beyond it, the client with the earliest time is forgotten.
constexpr std::size_t max_clients = 1000;

/// The key of a client: an IPv4 address, or the /64 network of an IPv6 address.
std::string to_client(const std::string& address) {
  std::array<char, sizeof(in6_addr)> bytes{};
  std::string bare = address.substr(0, address.find('%'));  // without the zone
  if (::inet_pton(AF_INET6, bare.c_str(), bytes.data()) != 1) {
    return address;
  }
  if (IN6_IS_ADDR_V4MAPPED(reinterpret_cast<const in6_addr*>(bytes.data()))) {
    return bare;
  }
  return {bytes.data(), bytes.size() / 2};
}

/// Makes room for a client that is not among `clients` yet.
void drop_oldest_before(std::map<std::string, GuessLimit::Time>& clients,
                        const std::string& client) {
  if (clients.size() >= max_clients && !clients.contains(client)) {
    clients.erase(
        std::ranges::min_element(clients, {}, [](const auto& entry) { return entry.second; }));
  }
}

/// Whether guesses that expire then leave one free now.
bool leaves_one(GuessLimit::Time expiry, GuessLimit::Time now, int free,
                std::chrono::seconds price) {
  return expiry - now <= (free - 1) * price;
}

/// Adds a guess to those that expire then. It costs its price, or, if that leaves none free, the
/// price on average.
void add_guess(GuessLimit::Time& expiry, GuessLimit::Time now, int free, std::chrono::seconds price,
               double chance) {
  expiry = std::max(expiry, now);
  expiry += leaves_one(expiry + price, now, free, price)
                ? std::chrono::nanoseconds(price)
                : std::chrono::duration_cast<std::chrono::nanoseconds>(chance * price);
}

}  // namespace

bool GuessLimit::allows(const std::string& address, Time now) const {
  const std::string client = to_client(address);
  const auto found = expiry_.find(client);
  return (found == expiry_.end() || leaves_one(found->second, now, free_guesses, guess_price)) &&
         (known_.contains(client) ||
          leaves_one(expiry_of_all_, now, free_guesses_of_all, guess_price_of_all));
}

void GuessLimit::count_wrong(const std::string& address, Time now, double chance) {
  std::erase_if(expiry_, [&](const auto& entry) { return entry.second <= now; });
  const std::string client = to_client(address);
  drop_oldest_before(expiry_, client);
  add_guess(expiry_.try_emplace(client, now).first->second, now, free_guesses, guess_price, chance);
  if (!known_.contains(client)) {
    add_guess(expiry_of_all_, now, free_guesses_of_all, guess_price_of_all, chance);
  }
}

void GuessLimit::remember(const std::string& session, const std::string& address, Time now) {
  const std::string client = to_client(address);
  drop_oldest_before(known_, client);
  known_.insert_or_assign(client, now);
  drop_oldest_before(sessions_, session);
  sessions_.insert_or_assign(session, now);
}

void GuessLimit::forget_known() {
  known_.clear();
  sessions_.clear();
}

}  // namespace octurn
