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

}  // namespace

std::chrono::seconds GuessLimit::to_wait(const std::string& address, Time now) const {
  const std::string client = to_client(address);
  const auto wait = [now](Time expiry, int free, std::chrono::seconds price) {
    return std::max(std::chrono::seconds(0),
                    std::chrono::ceil<std::chrono::seconds>(expiry - now - (free - 1) * price));
  };
  const auto found = expiry_.find(client);
  const auto own = found == expiry_.end() ? std::chrono::seconds(0)
                                          : wait(found->second, free_guesses, guess_price);
  return known_.contains(client)
             ? own
             : std::max(own, wait(expiry_of_all_, free_guesses_of_all, guess_price_of_all));
}

void GuessLimit::count_wrong(const std::string& address, Time now) {
  std::erase_if(expiry_, [&](const auto& entry) { return entry.second <= now; });
  const std::string client = to_client(address);
  drop_oldest_before(expiry_, client);
  const auto [entry, fresh] = expiry_.try_emplace(client, now);
  entry->second += guess_price;
  if (!known_.contains(client)) {
    expiry_of_all_ = std::max(expiry_of_all_, now) + guess_price_of_all;
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
