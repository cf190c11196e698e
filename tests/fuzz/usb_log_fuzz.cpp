#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "octurn/error.hpp"
#include "rig/usb_log.hpp"

// Any text is refused by an Error of one line, or gives packets whose text gives them again, but
// for the time of the first one. They show whole frames, of which no more packets arrived than
// there are.

namespace {

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

void check(std::vector<octurn::UsbPacket> packets) {
  const std::int64_t begin = packets.empty() ? 0 : packets.front().time_us;
  for (octurn::UsbPacket& packet : packets) {
    packet.time_us -= begin;
  }
  require(octurn::parse_usb_log(octurn::to_usb_log_text(packets, {})) == packets);
  const std::vector<bool> lost = octurn::lost_packets(packets);
  require(lost.size() % 242 == 0);
  require(std::ranges::count(lost, false) <= std::ssize(packets));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check(octurn::parse_usb_log({reinterpret_cast<const char*>(data), size}));
  } catch (const octurn::Error& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
