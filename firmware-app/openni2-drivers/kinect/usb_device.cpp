#include "kinect/usb_device.hpp"

#include <sys/time.h>

#include <algorithm>
#include <array>
#include <utility>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

constexpr std::uint16_t microsoft = 0x045E;
constexpr timeval longest_wait = {.tv_sec = 0, .tv_usec = 20'000};  // a stop request's delay
constexpr auto end_patience = std::chrono::milliseconds(500);

// 256 microframes, 32 ms: what a machine may take to come back to the stream.
constexpr std::size_t transfers_in_flight = 16;
constexpr int packets_in_transfer = 16;
constexpr int nominal_packet_bytes = 1920;  // two transactions of 960 bytes in a microframe

using DeviceList = std::unique_ptr<libusb_device*, void (*)(libusb_device**)>;

std::pair<DeviceList, std::span<libusb_device*>> list_devices(libusb_context* context) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context, &devices);
  DeviceList owned(count < 0 ? nullptr : devices,
                   [](libusb_device** list) { libusb_free_device_list(list, 1); });
  const std::span all(devices, count < 0 ? 0 : static_cast<std::size_t>(count));
  return {std::move(owned), all};
}

std::optional<UsbPart> part_of(libusb_device* device) {
  libusb_device_descriptor descriptor = {};
  if (libusb_get_device_descriptor(device, &descriptor) < 0 || descriptor.idVendor != microsoft) {
    return std::nullopt;
  }
  libusb_device* const hub = libusb_get_parent(device);
  return UsbPart{.bus = libusb_get_bus_number(device),
                 .address = libusb_get_device_address(device),
                 .hub = hub == nullptr ? 0 : libusb_get_device_address(hub),
                 .product = descriptor.idProduct,
                 .release = descriptor.bcdDevice};
}

Error cannot_open() {
  return Error(ErrorCode::sensor_missing, "kinect: it is plugged in but cannot be opened");
}

[[noreturn]] void throw_lost() { throw Error(ErrorCode::sensor_lost, "kinect: it is gone"); }

/// Opens the device's only interface. The kernel's driver of webcams is asked to let go of it.
/// @return whether that succeeded
bool claim(libusb_device_handle* handle, const UsbPart& part) {
  if (libusb_kernel_driver_active(handle, 0) == 1) {
    libusb_detach_kernel_driver(handle, 0);
  }
  // The endpoints of a Kinect for Windows have their size in the alternate setting only.
  return libusb_claim_interface(handle, 0) == 0 &&
         (!part.is_for_windows() || libusb_set_interface_alt_setting(handle, 0, 1) == 0);
}

}  // namespace

std::vector<UsbPart> usb_parts() {
  const auto context = UsbDevice::make_context();
  const auto listed = list_devices(context.get());
  std::vector<UsbPart> parts;
  for (libusb_device* device : listed.second) {
    if (const auto part = part_of(device)) {
      parts.push_back(*part);
    }
  }
  std::ranges::sort(parts, {},
                    [](const UsbPart& part) { return std::pair(part.bus, part.address); });
  return parts;
}

std::unique_ptr<libusb_context, UsbDevice::ContextEnd> UsbDevice::make_context() {
  libusb_context* context = nullptr;
  if (libusb_init(&context) < 0) {
    throw Error(ErrorCode::sensor_missing, "kinect: this machine's USB cannot be used");
  }
  return std::unique_ptr<libusb_context, ContextEnd>(context);
}

UsbDevice::UsbDevice(const UsbPart& part) : context_(make_context()) {
  const auto listed = list_devices(context_.get());
  for (libusb_device* device : listed.second) {
    const auto found = part_of(device);
    if (!found || found->bus != part.bus || found->address != part.address) {
      continue;
    }
    libusb_device_handle* handle = nullptr;
    if (libusb_open(device, &handle) != 0) {
      throw cannot_open();
    }
    handle_.reset(handle);
    // The audio part keeps its drivers: only its serial number is read.
    if (!part.is_audio() && !claim(handle, part)) {
      throw cannot_open();
    }
    return;
  }
  throw cannot_open();
}

UsbDevice::~UsbDevice() = default;

std::string UsbDevice::serial() const {
  libusb_device_descriptor descriptor = {};
  std::array<unsigned char, 256> text = {};
  if (libusb_get_device_descriptor(libusb_get_device(handle_.get()), &descriptor) < 0 ||
      descriptor.iSerialNumber == 0) {
    return {};
  }
  const int count = libusb_get_string_descriptor_ascii(handle_.get(), descriptor.iSerialNumber,
                                                       text.data(), static_cast<int>(text.size()));
  const std::string serial(text.begin(), text.begin() + std::max(count, 0));
  return serial.find_first_not_of('0') == serial.npos ? std::string() : serial;
}

int UsbDevice::control(std::uint8_t type, std::uint8_t request, std::span<std::uint8_t> data,
                       std::chrono::milliseconds timeout) {
  const int result = libusb_control_transfer(handle_.get(), type, request, 0, 0, data.data(),
                                             static_cast<std::uint16_t>(data.size()),
                                             static_cast<unsigned>(timeout.count()));
  if (result == LIBUSB_ERROR_NO_DEVICE) {
    throw_lost();
  }
  return result;
}

int UsbDevice::write(std::uint8_t request, std::span<const std::uint8_t> data,
                     std::chrono::milliseconds timeout) {
  std::vector<std::uint8_t> copy(data.begin(), data.end());  // libusb takes no constant data
  return control(0x40, request, copy, timeout);
}

int UsbDevice::read(std::uint8_t request, std::span<std::uint8_t> data,
                    std::chrono::milliseconds timeout) {
  return control(0xC0, request, data, timeout);
}

void UsbDevice::begin_stream(std::uint8_t endpoint,
                             std::function<void(const IsoPacket&)> on_packet) {
  if (in_flight_ > 0) {  // an earlier stream's, which the device has not given back
    throw_lost();
  }
  on_packet_ = std::move(on_packet);
  ends_ = false;
  const int reported = libusb_get_max_iso_packet_size(libusb_get_device(handle_.get()), endpoint);
  const int packet_bytes = reported > 0 ? reported : nominal_packet_bytes;
  transfers_.clear();
  for (std::size_t i = 0; i < transfers_in_flight; ++i) {
    Transfer& made = transfers_.emplace_back();
    made.buffer.resize(static_cast<std::size_t>(packets_in_transfer * packet_bytes));
    made.transfer.reset(libusb_alloc_transfer(packets_in_transfer));
    libusb_fill_iso_transfer(
        made.transfer.get(), handle_.get(), endpoint, made.buffer.data(),
        static_cast<int>(made.buffer.size()), packets_in_transfer,
        [](libusb_transfer* transfer) noexcept {
          static_cast<UsbDevice*>(transfer->user_data)->take(*transfer);
        },
        this, 0);
    libusb_set_iso_packet_lengths(made.transfer.get(), static_cast<unsigned>(packet_bytes));
    in_flight_ += libusb_submit_transfer(made.transfer.get()) == 0 ? 1 : 0;
  }
  if (in_flight_ == 0) {
    throw_lost();
  }
}

/// Takes a transfer's packets, and lets the device fill it again.
void UsbDevice::take(libusb_transfer& transfer) {
  --in_flight_;
  if (ends_ || transfer.status == LIBUSB_TRANSFER_NO_DEVICE ||
      transfer.status == LIBUSB_TRANSFER_CANCELLED) {
    return;
  }
  const steady_clock::time_point now = steady_clock::now();
  const std::uint8_t* data = transfer.buffer;
  for (int i = 0; i < transfer.num_iso_packets; ++i) {
    const libusb_iso_packet_descriptor& packet = transfer.iso_packet_desc[i];
    const bool is_completed = packet.status == LIBUSB_TRANSFER_COMPLETED;
    on_packet_({.time = now,
                .status = static_cast<std::uint16_t>(packet.status),
                .data = std::span(data, is_completed ? packet.actual_length : 0)});
    data += packet.length;
  }
  in_flight_ += libusb_submit_transfer(&transfer) == 0 ? 1 : 0;
}

/// A signal that interrupts the wait, as when the program is stopped and continued, ends nothing.
bool UsbDevice::handle_events() {
  timeval longest = longest_wait;
  const int result = libusb_handle_events_timeout(context_.get(), &longest);
  return (result >= 0 || result == LIBUSB_ERROR_INTERRUPTED) && in_flight_ > 0;
}

bool UsbDevice::end_stream() {
  ends_ = true;
  for (const Transfer& one : transfers_) {
    libusb_cancel_transfer(one.transfer.get());
  }
  const auto deadline = steady_clock::now() + end_patience;
  while (handle_events() && steady_clock::now() < deadline) {
  }
  return in_flight_ == 0;
}

}  // namespace octurn
