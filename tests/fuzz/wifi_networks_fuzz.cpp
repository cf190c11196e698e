#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "appliance/wifi.hpp"

// For any table, the networks taken from it can be joined by a request, are unique, and are sorted
// by decreasing signal.

namespace {

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<octurn::WifiNetwork> networks =
      octurn::wifi_networks({reinterpret_cast<const char*>(data), size});
  std::set<std::string> names;
  for (const octurn::WifiNetwork& network : networks) {
    require(octurn::is_wifi_name(network.name));
    require(names.insert(network.name).second);
  }
  require(
      std::ranges::is_sorted(networks, std::ranges::greater(), &octurn::WifiNetwork::signal_dbm));
  return 0;
}
