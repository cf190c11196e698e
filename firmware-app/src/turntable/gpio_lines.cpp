#include "turntable/gpio_lines.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include "octurn/error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// The kernel's labels of the header's chip: Pi 3 and older, Pi 4, Pi 5. The number N of its
/// /dev/gpiochipN differs from kernel to kernel.
constexpr std::array<const char*, 3> header_labels = {"pinctrl-bcm2835", "pinctrl-bcm2711",
                                                      "pinctrl-rp1"};

constexpr unsigned first_header_line = 2;
constexpr unsigned last_header_line = 27;

std::vector<fs::path> chip_devices() {
  std::vector<fs::path> devices;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev")) {
    if (entry.path().filename().string().starts_with("gpiochip")) {
      devices.push_back(entry.path());
    }
  }
  std::ranges::sort(devices);
  return devices;
}

GpioChip header_chip() {
  std::string others;
  for (const fs::path& device : chip_devices()) {
    try {
      GpioChip chip(device);
      const std::string label = chip.label();
      if (std::ranges::find(header_labels, label) != header_labels.end()) {
        return chip;
      }
      others += (others.empty() ? "" : ", ") + label;
    } catch (const std::system_error& error) {
      throw Error(ErrorCode::turntable_failed, device.string() + " cannot be used: " + error.what(),
                  "Let this user use GPIO: sudo adduser $USER gpio, and log in again.");
    }
  }
  throw Error(ErrorCode::turntable_missing,
              "this machine has no GPIO header of a Raspberry Pi" +
                  (others.empty() ? "" : ", only " + others),
              "Run this on a Raspberry Pi whose kernel knows its GPIO chip, or add --simulate.");
}

std::optional<unsigned> find_line(const GpioChip& header, const std::string& name) {
  const std::optional<unsigned> offset = header_offset(name);
  return offset ? offset : header.find_offset(name);
}

/// @param cure  as of `drive_header`
unsigned free_line(const GpioChip& chip, const std::string& name, const std::string& cure) {
  const std::optional<unsigned> offset = find_line(chip, name);
  if (!offset) {
    throw Error(
        ErrorCode::turntable_failed, "the GPIO header has no line " + name,
        cure.empty() ? "Correct the lines in octurn.json; they are called GPIO2 to GPIO27." : cure);
  }
  if (const std::optional<std::string> other = chip.find_user(*offset)) {
    throw Error(ErrorCode::turntable_failed, "line " + name + " is in use by " + *other,
                *other == gpio_user ? "End the other Octurn first."
                : cure.empty()      ? "End what uses it, or choose another line in octurn.json."
                                    : cure);
  }
  return *offset;
}

}  // namespace

std::optional<unsigned> header_offset(std::string_view name) {
  constexpr std::string_view prefix = "GPIO";
  if (!name.starts_with(prefix)) {
    return std::nullopt;
  }
  name.remove_prefix(prefix.size());
  for (unsigned number = first_header_line; number <= last_header_line; ++number) {
    if (name == std::to_string(number)) {
      return number;
    }
  }
  return std::nullopt;
}

HeaderUse read_header_use(const std::vector<NamedLine>& lines) {
  const GpioChip chip = header_chip();
  try {
    HeaderUse use{.label = chip.label()};
    for (const NamedLine& line : lines) {
      const std::optional<unsigned> offset = find_line(chip, line.name);
      use.lines.push_back({.name = line.name,
                           .exists = offset.has_value(),
                           .user = offset ? chip.find_user(*offset) : std::nullopt});
    }
    return use;
  } catch (const std::system_error& error) {
    throw Error(ErrorCode::turntable_failed,
                std::string("the GPIO lines cannot be read: ") + error.what(),
                "Start this machine again.");
  }
}

GpioChip drive_header(const std::vector<NamedLine>& lines, const std::string& cure) {
  GpioChip chip = header_chip();
  try {
    std::vector<OutputLine> outputs;
    outputs.reserve(lines.size());
    for (const NamedLine& line : lines) {
      outputs.push_back({.offset = free_line(chip, line.name, cure), .high = line.high});
    }
    chip.drive(outputs, gpio_user);
  } catch (const std::system_error& error) {
    throw Error(ErrorCode::turntable_failed,
                std::string("the GPIO lines cannot be driven: ") + error.what(),
                "End other programs that use GPIO, and retry.");
  }
  return chip;
}

}  // namespace octurn
