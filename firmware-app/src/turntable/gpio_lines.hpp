#pragma once

#include <optional>
#include <string>
#include <vector>

#include "turntable/gpio_chip.hpp"

namespace octurn {

/// A line of the GPIO header by the kernel's name for it, and its level until it is set.
struct NamedLine {
  std::string name = {};  ///< "GPIO17", as the pins are called in the Pi's own papers
  bool high = false;
};

/// What the kernel knows of a line.
struct LineUse {
  std::string name = {};
  bool exists = true;
  std::optional<std::string> user = {};  ///< nothing: it is free
};

/// The chip behind a Raspberry Pi's GPIO header, and lines of it.
struct HeaderUse {
  std::string label = {};
  std::vector<LineUse> lines = {};
};

/// Looks at lines of the header without taking hold of any.
/// @throws Error "turntable-missing"  if this machine has no such header
/// @throws Error "turntable-failed"   if its chip may not be used
HeaderUse look_at_header(const std::vector<NamedLine>& lines);

/// What this program calls itself where the kernel keeps the user of a line.
inline constexpr const char* gpio_user = "octurn";

/// Lines of a Raspberry Pi's GPIO header that this program drives as long as this lives: released
/// lines become inputs again.
class GpioLines {
 public:
  /// @throws Error "turntable-missing"  if this machine has no such header
  /// @throws Error "turntable-failed"   if a line is not there, or somebody else's, or may not be
  ///                                    used: names line and user
  explicit GpioLines(std::vector<NamedLine> lines);

  /// @param line  as counted in what was given
  /// @throws Error "turntable-failed"
  void set(std::size_t line, bool high);

 private:
  std::vector<NamedLine> lines_;
  GpioChip chip_;
};

}  // namespace octurn
