#include "failure.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

namespace octurn {
namespace {

struct DeviceCode {
  std::string_view code;
  Device device;
  bool is_absence = false;
};

constexpr std::array<DeviceCode, 10> device_codes{{
    {"sensor-missing", Device::sensor, true},
    {"sensor-failed", Device::sensor},
    {"sensor-silent", Device::sensor},
    {"sensor-lost", Device::sensor},
    {"sensor-blind", Device::sensor},
    {"sensor-other", Device::sensor},
    {"recording-malformed", Device::sensor},
    {"turntable-missing", Device::turntable, true},
    {"turntable-failed", Device::turntable},
    {"turntable-lost", Device::turntable},
}};

DeviceCode find(std::string_view code) {
  const auto* found = std::ranges::find(device_codes, code, &DeviceCode::code);
  return found == device_codes.end() ? DeviceCode{code, Device::none} : *found;
}

}  // namespace

Device Failure::device() const { return find(code).device; }

bool Failure::is_absence() const { return find(code).is_absence; }

Failure failure_of(const Error& error) {
  return {.code = error.code(), .detail = error.what(), .hint = error.hint()};
}

Failure current_failure() {
  const std::string hint = "Please report this.";
  try {
    throw;
  } catch (const Error& error) {
    return failure_of(error);
  } catch (const std::exception& error) {
    return {.code = "internal", .detail = error.what(), .hint = hint};
  } catch (...) {
    return {.code = "internal", .detail = "an unknown exception", .hint = hint};
  }
}

Error to_error(const Failure& failure) { return Error(failure.code, failure.detail, failure.hint); }

}  // namespace octurn
