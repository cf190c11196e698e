#include "http/guess_limit.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

namespace octurn {
namespace {

// More than a home network has. Beyond it, the client whose guesses expire first is forgotten.
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

}  // namespace

std::chrono::seconds GuessLimit::to_wait(const std::string& address, Time now) const {
  const auto found = expiry_.find(to_client(address));
  if (found == expiry_.end()) {
    return std::chrono::seconds(0);
  }
  const auto wait = found->second - now - (free_guesses - 1) * guess_price;
  return std::max(std::chrono::seconds(0), std::chrono::ceil<std::chrono::seconds>(wait));
}

void GuessLimit::count_wrong(const std::string& address, Time now) {
  std::erase_if(expiry_, [&](const auto& entry) { return entry.second <= now; });
  const std::string client = to_client(address);
  if (expiry_.size() >= max_clients && !expiry_.contains(client)) {
    expiry_.erase(
        std::ranges::min_element(expiry_, {}, [](const auto& entry) { return entry.second; }));
  }
  const auto [entry, fresh] = expiry_.try_emplace(client, now);
  entry->second += guess_price;
}

void GuessLimit::forgive(const std::string& address) { expiry_.erase(to_client(address)); }

}  // namespace octurn
