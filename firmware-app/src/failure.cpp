#include "failure.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

namespace octurn {
namespace {

struct DeviceCode {
  ErrorCode code;
  Device device;
  bool is_absence = false;
};

constexpr std::array<DeviceCode, 10> device_codes{{
    {ErrorCode::sensor_missing, Device::sensor, true},
    {ErrorCode::sensor_failed, Device::sensor},
    {ErrorCode::sensor_silent, Device::sensor},
    {ErrorCode::sensor_lost, Device::sensor},
    {ErrorCode::sensor_blind, Device::sensor},
    {ErrorCode::sensor_other, Device::sensor},
    {ErrorCode::recording_malformed, Device::sensor},
    {ErrorCode::turntable_missing, Device::turntable, true},
    {ErrorCode::turntable_failed, Device::turntable},
    {ErrorCode::turntable_lost, Device::turntable},
}};

DeviceCode find(ErrorCode code) {
  const auto* found = std::ranges::find(device_codes, code, &DeviceCode::code);
  return found == device_codes.end() ? DeviceCode{code, Device::none} : *found;
}

}  // namespace

Device Failure::device() const { return find(code).device; }

bool Failure::is_absence() const { return find(code).is_absence; }

Failure to_failure(const Error& error) {
  return {.code = error.code(),
          .detail = error.what(),
          .hint = error.hint(),
          .parameters = error.parameters()};
}

Failure current_failure() {
  const std::string hint = "Please report this.";
  try {
    throw;
  } catch (const Error& error) {
    return to_failure(error);
  } catch (const std::exception& error) {
    return {.code = ErrorCode::internal, .detail = error.what(), .hint = hint};
  } catch (...) {
    return {.code = ErrorCode::internal, .detail = "an unknown exception", .hint = hint};
  }
}

Error to_error(const Failure& failure) {
  return Error(failure.code, failure.detail, failure.hint, failure.parameters);
}

}  // namespace octurn
