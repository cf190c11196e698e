#include "appliance/wifi_networks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <functional>
#include <optional>
#include <system_error>

#include "appliance/wifi_request.hpp"
#include "octurn/json_object.hpp"

namespace octurn {
namespace {

/// Removes the front of a text up to and including the first `separator`.
/// @return the removed text, without the separator
std::string_view take_until(char separator, std::string_view& text) {
  const std::string_view taken = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(taken.size() + 1, text.size()));
  return taken;
}

template <typename Number>
std::optional<Number> parse_number(std::string_view text, int base) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

/// Removes an escape from the front of a text: `\xc3`, `\"`, `\\`, `\e`, `\n`, `\r` or `\t`
/// (wpa_supplicant, printf_encode in src/utils/common.c). @return its byte; nothing: no escape
std::optional<char> take_escape(std::string_view& text) {
  constexpr std::string_view letters = R"("\enrt)";
  constexpr std::array bytes{'"', '\\', '\x1b', '\n', '\r', '\t'};
  if (text.starts_with('x') && text.size() >= 3) {
    const auto byte = parse_number<unsigned char>(text.substr(1, 2), 16);
    text.remove_prefix(3);
    return byte ? std::optional(static_cast<char>(*byte)) : std::nullopt;
  }
  const std::size_t letter = text.empty() ? letters.npos : letters.find(text.front());
  if (letter == letters.npos) {
    return std::nullopt;
  }
  text.remove_prefix(1);
  return bytes[letter];
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    const std::optional<char> byte = c == '\\' ? take_escape(text) : c;
    if (!byte) {
      return std::nullopt;
    }
    bytes += *byte;
  }
  return bytes;
}

/// Parses a line: bssid, frequency, signal, flags and name, separated by tabs.
std::optional<WifiNetwork> network_in(std::string_view line) {
  take_until('\t', line);
  take_until('\t', line);
  const auto signal_dbm = parse_number<int>(take_until('\t', line), 10);
  const std::string_view flags = take_until('\t', line);
  const std::optional<std::string> name = unescaped(line);
  if (!signal_dbm || !name || !is_wifi_name(*name) || !is_utf8(*name)) {
    return std::nullopt;
  }
  const auto has = [&](std::string_view flag) { return flags.find(flag) != flags.npos; };
  return WifiNetwork{.name = *name,
                     .signal_dbm = *signal_dbm,
                     .secured = has("WPA") || has("WEP") || has("RSN") || has("SAE")};
}

}  // namespace

std::vector<WifiNetwork> wifi_networks(std::string_view scan_results) {
  std::vector<WifiNetwork> networks;
  take_until('\n', scan_results);  // the header line
  while (!scan_results.empty()) {
    if (auto network = network_in(take_until('\n', scan_results))) {
      networks.push_back(*std::move(network));
    }
  }
  std::ranges::stable_sort(networks, std::ranges::greater(), &WifiNetwork::signal_dbm);
  std::vector<WifiNetwork> strongest;
  for (WifiNetwork& network : networks) {
    if (std::ranges::find(strongest, network.name, &WifiNetwork::name) == strongest.end()) {
      strongest.push_back(std::move(network));
    }
  }
  return strongest;
}

}  // namespace octurn
