#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace octurn {

/// The version of libgpiod.
std::string gpiod_version();

/// An output line and its initial level.
struct OutputLine {
  unsigned offset = 0;  ///< on its chip
  bool high = false;
};

/// A GPIO chip of the kernel and those of its lines that this program drives. libgpiod 1 and 2 have
/// different interfaces: gpio_chip_v1.cpp and gpio_chip_v2.cpp both implement this class, and one
/// of them is compiled.
///
/// Every function throws std::system_error with the kernel's errno.
class GpioChip {
 public:
  explicit GpioChip(const std::filesystem::path& device);
  GpioChip(GpioChip&& other) noexcept;
  GpioChip& operator=(GpioChip&& other) noexcept;
  GpioChip(const GpioChip&) = delete;
  GpioChip& operator=(const GpioChip&) = delete;
  ~GpioChip();

  std::string label() const;

  /// The offset of the line of that name; nothing if the chip has none.
  std::optional<unsigned> find_offset(const std::string& name) const;

  /// The consumer of a line as the kernel reports it; nothing if the line is free.
  std::optional<std::string> find_user(unsigned offset) const;

  /// Requests all lines at once as outputs, for the lifetime of this object. Called once.
  void drive(const std::vector<OutputLine>& lines, const std::string& user);

  /// @param line  index into the lines that `drive` was given
  void set(std::size_t line, bool high);

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace octurn
