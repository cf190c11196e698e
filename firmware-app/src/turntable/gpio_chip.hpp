#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace octurn {

/// Of libgpiod.
std::string gpiod_version();

/// A line that this program drives, and its level from the moment that it does.
struct OutputLine {
  unsigned offset = 0;  ///< on its chip
  bool high = false;
};

/// A GPIO chip of the kernel and the lines of it that this program drives: libgpiod 1 or 2, which
/// have nothing in common, in gpio_chip_v1.cpp or gpio_chip_v2.cpp.
///
/// Everything throws std::system_error with what the kernel says.
class GpioChip {
 public:
  explicit GpioChip(const std::filesystem::path& device);
  GpioChip(GpioChip&& other) noexcept;
  GpioChip& operator=(GpioChip&& other) noexcept;
  GpioChip(const GpioChip&) = delete;
  GpioChip& operator=(const GpioChip&) = delete;
  ~GpioChip();

  std::string label() const;

  /// The line of that name, if the chip has it.
  std::optional<unsigned> offset_of(const std::string& name) const;

  /// Who uses a line, as the kernel knows it; nothing if it is free.
  std::optional<std::string> user_of(unsigned offset) const;

  /// Takes hold of lines, all at once, until the end of this object. To be called once.
  void drive(const std::vector<OutputLine>& lines, const std::string& user);

  /// @param line  as counted in what `drive` was given
  void set(std::size_t line, bool high);

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace octurn
