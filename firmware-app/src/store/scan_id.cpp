#include "store/scan_id.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "utc.hpp"

namespace octurn {
namespace {

constexpr std::string_view id_form = "00000000-000000-xxxx";

}  // namespace

bool is_scan_id(std::string_view text) {
  return std::ranges::equal(text, id_form, [](char c, char form) {
    const bool digit = c >= '0' && c <= '9';
    return form == '0' ? digit : form == 'x' ? digit || (c >= 'a' && c <= 'f') : c == form;
  });
}

std::string to_scan_id(ScanTime time) {
  auto fraction = (time - std::chrono::floor<std::chrono::seconds>(time)).count();
  std::string digits(4, '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, fraction >>= 4) {
    *digit = "0123456789abcdef"[fraction & 0xf];
  }
  return utc_text(time, "%Y%m%d-%H%M%S-") + digits;
}

ScanTime to_time(const std::string& id) {
  std::tm utc{};
  const char* const fraction = ::strptime(id.c_str(), "%Y%m%d-%H%M%S-", &utc);
  return ScanTime(std::chrono::seconds(::timegm(&utc))) +
         ScanTime::duration(fraction == nullptr ? 0 : std::strtol(fraction, nullptr, 16));
}

}  // namespace octurn
