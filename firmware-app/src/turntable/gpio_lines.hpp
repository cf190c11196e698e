#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "turntable/gpio_chip.hpp"

namespace octurn {

/// A line of the GPIO header, and its initial level.
struct NamedLine {
  std::string name = {};  ///< as in the Pi's documentation, "GPIO17", or the kernel's own
  bool high = false;
};

/// A line's state as the kernel reports it.
struct LineUse {
  std::string name = {};
  bool exists = true;
  std::optional<std::string> user = {};  ///< nothing: the line is free
};

/// The chip behind a Raspberry Pi's GPIO header, and some of its lines.
struct HeaderUse {
  std::string label = {};
  std::vector<LineUse> lines = {};
};

/// The offset of GPIO2 to GPIO27 on the header's chip, which is their number. Device trees name
/// some of them by what they may also be used for, and not alike: GPIO2 is SDA1 to Debian's kernel.
/// @return nothing for any other name
std::optional<unsigned> header_offset(std::string_view name);

/// Reads the use of lines of the header without requesting any.
/// @throws Error "turntable-missing"  if this machine has no such header
/// @throws Error "turntable-failed"   if its chip cannot be accessed
HeaderUse read_header_use(const std::vector<NamedLine>& lines);

/// This program's name as the consumer of a line.
inline constexpr const char* gpio_user = "octurn";

/// Drives lines of a Raspberry Pi's GPIO header as long as the returned chip lives. Released lines
/// become inputs again.
/// @throws Error "turntable-missing"  if this machine has no such header
/// @throws Error "turntable-failed"   if a line does not exist, is in use or cannot be accessed:
///                                    names the line and its user
/// @param cure  hint of an error that other lines would cure; empty: that of a turntable's lines
GpioChip drive_header(const std::vector<NamedLine>& lines, const std::string& cure = {});

}  // namespace octurn
