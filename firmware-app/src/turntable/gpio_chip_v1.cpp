#include <gpiod.h>

#include <cerrno>
#include <system_error>

#include "turntable/gpio_chip.hpp"

namespace octurn {
namespace {

[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category()); }

}  // namespace

std::string gpiod_version() { return gpiod_version_string(); }

struct GpioChip::Handles {
  struct CloseChip {
    void operator()(gpiod_chip* handle) const { gpiod_chip_close(handle); }  // frees its lines, too
  };

  std::unique_ptr<gpiod_chip, CloseChip> chip;
  gpiod_line_bulk driven = GPIOD_LINE_BULK_INITIALIZER;
};

GpioChip::GpioChip(const std::filesystem::path& device) : handles_(std::make_unique<Handles>()) {
  handles_->chip.reset(gpiod_chip_open(device.c_str()));
  if (!handles_->chip) {
    fail();
  }
}

GpioChip::GpioChip(GpioChip&& other) noexcept = default;
GpioChip& GpioChip::operator=(GpioChip&& other) noexcept = default;
GpioChip::~GpioChip() = default;

std::string GpioChip::label() const { return gpiod_chip_label(handles_->chip.get()); }

std::optional<unsigned> GpioChip::find_offset(const std::string& name) const {
  gpiod_line* line = gpiod_chip_find_line(handles_->chip.get(), name.c_str());
  return line == nullptr ? std::nullopt : std::optional(gpiod_line_offset(line));
}

std::optional<std::string> GpioChip::find_user(unsigned offset) const {
  gpiod_line* line = gpiod_chip_get_line(handles_->chip.get(), offset);
  if (line == nullptr) {
    fail();
  }
  if (!gpiod_line_is_used(line)) {
    return std::nullopt;
  }
  const char* user = gpiod_line_consumer(line);
  return user == nullptr ? "the kernel" : user;
}

void GpioChip::drive(const std::vector<OutputLine>& lines, const std::string& user) {
  std::vector<int> levels;
  for (const OutputLine& line : lines) {
    gpiod_line* handle = gpiod_chip_get_line(handles_->chip.get(), line.offset);
    if (handle == nullptr) {
      fail();
    }
    gpiod_line_bulk_add(&handles_->driven, handle);
    levels.push_back(line.high ? 1 : 0);
  }
  if (gpiod_line_request_bulk_output(&handles_->driven, user.c_str(), levels.data()) != 0) {
    fail();
  }
}

void GpioChip::set(std::size_t line, bool high) {
  gpiod_line* handle = gpiod_line_bulk_get_line(&handles_->driven, static_cast<unsigned>(line));
  if (gpiod_line_set_value(handle, high ? 1 : 0) != 0) {
    fail();
  }
}

}  // namespace octurn
