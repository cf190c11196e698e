#pragma once

#include <OniCTypes.h>

#include <cstring>
#include <string>
#include <type_traits>

namespace octurn {

/// Copies the value of a property to OpenNI2.
/// @return ONI_STATUS_BAD_PARAMETER if the caller expects another size
template <typename Value>
OniStatus give_property(const Value& value, void* data, int* size) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (*size != static_cast<int>(sizeof value)) {
    return ONI_STATUS_BAD_PARAMETER;
  }
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

/// Copies a text to OpenNI2, with a terminating NUL.
/// @return ONI_STATUS_BAD_PARAMETER if the caller's buffer is too small
inline OniStatus give_text(const std::string& text, void* data, int* size) {
  const auto length = static_cast<int>(text.size()) + 1;
  if (*size < length) {
    return ONI_STATUS_BAD_PARAMETER;
  }
  std::memcpy(data, text.c_str(), static_cast<std::size_t>(length));
  *size = length;
  return ONI_STATUS_OK;
}

/// Takes a new value of a property.
/// @return ONI_STATUS_BAD_PARAMETER if it has another size
template <typename Value>
OniStatus take_property(Value& value, const void* data, int size) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (size != static_cast<int>(sizeof value)) {
    return ONI_STATUS_BAD_PARAMETER;
  }
  std::memcpy(&value, data, sizeof value);
  return ONI_STATUS_OK;
}

}  // namespace octurn
