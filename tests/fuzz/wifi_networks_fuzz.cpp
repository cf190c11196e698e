#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "appliance/wifi_networks.hpp"
#include "appliance/wifi_request.hpp"

// Whatever the table, each network that is taken from it can be asked for, is there once, and none
// is stronger than the one before it.

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
