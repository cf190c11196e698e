#include <gpiod.h>

#include <cerrno>
#include <system_error>

#include "turntable/gpio_chip.hpp"

namespace octurn {

/// Deleter of a libgpiod object by the free function of its type. A class has such members, so it
/// is not in the anonymous namespace.
template <auto free>
struct FreeGpiod {
  template <typename Handle>
  void operator()(Handle* handle) const {
    free(handle);
  }
};
template <typename Handle, auto free>
using Owned = std::unique_ptr<Handle, FreeGpiod<free>>;

namespace {

[[noreturn]] void fail() { throw std::system_error(errno, std::generic_category()); }

/// Checks a new object of libgpiod. @throws std::system_error  if it is null
template <typename Handle>
Handle* made(Handle* handle) {
  return handle != nullptr ? handle : (fail(), handle);
}

gpiod_line_value to_line_value(bool high) {
  return high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

}  // namespace

std::string gpiod_version() { return gpiod_api_version(); }

struct GpioChip::Handles {
  Owned<gpiod_chip, gpiod_chip_close> chip;
  Owned<gpiod_line_request, gpiod_line_request_release> request = {};
  std::vector<unsigned> driven = {};  // offsets
};

GpioChip::GpioChip(const std::filesystem::path& device) : handles_(std::make_unique<Handles>()) {
  handles_->chip.reset(made(gpiod_chip_open(device.c_str())));
}

GpioChip::GpioChip(GpioChip&& other) noexcept = default;
GpioChip& GpioChip::operator=(GpioChip&& other) noexcept = default;
GpioChip::~GpioChip() = default;

std::string GpioChip::label() const {
  const Owned<gpiod_chip_info, gpiod_chip_info_free> info(
      made(gpiod_chip_get_info(handles_->chip.get())));
  return gpiod_chip_info_get_label(info.get());
}

std::optional<unsigned> GpioChip::find_offset(const std::string& name) const {
  const int offset = gpiod_chip_get_line_offset_from_name(handles_->chip.get(), name.c_str());
  return offset < 0 ? std::nullopt : std::optional(static_cast<unsigned>(offset));
}

std::optional<std::string> GpioChip::find_user(unsigned offset) const {
  const Owned<gpiod_line_info, gpiod_line_info_free> info(
      made(gpiod_chip_get_line_info(handles_->chip.get(), offset)));
  if (!gpiod_line_info_is_used(info.get())) {
    return std::nullopt;
  }
  const char* user = gpiod_line_info_get_consumer(info.get());
  return user == nullptr ? "the kernel" : user;
}

void GpioChip::drive(const std::vector<OutputLine>& lines, const std::string& user) {
  const Owned<gpiod_line_config, gpiod_line_config_free> config(made(gpiod_line_config_new()));
  const Owned<gpiod_line_settings, gpiod_line_settings_free> settings(
      made(gpiod_line_settings_new()));
  const Owned<gpiod_request_config, gpiod_request_config_free> request(
      made(gpiod_request_config_new()));
  gpiod_request_config_set_consumer(request.get(), user.c_str());
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  for (const OutputLine& line : lines) {
    gpiod_line_settings_set_output_value(settings.get(), to_line_value(line.high));
    if (gpiod_line_config_add_line_settings(config.get(), &line.offset, 1, settings.get()) != 0) {
      fail();
    }
    handles_->driven.push_back(line.offset);
  }
  handles_->request.reset(
      made(gpiod_chip_request_lines(handles_->chip.get(), request.get(), config.get())));
}

void GpioChip::set(std::size_t line, bool high) {
  if (gpiod_line_request_set_value(handles_->request.get(), handles_->driven[line],
                                   to_line_value(high)) != 0) {
    fail();
  }
}

}  // namespace octurn
