#pragma once

#include <libusb.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace octurn {

/// One of the USB devices of a Kinect, which is a hub with up to three of them.
struct UsbPart {
  int bus = 0;
  int address = 0;  ///< on that bus
  int hub = 0;      ///< address of the hub; 0 if it is unknown
  std::uint16_t product = 0;
  std::uint16_t release = 0;  ///< the device's, bcdDevice

  bool is_camera() const { return product == 0x02AE || is_for_windows(); }
  bool is_for_windows() const { return product == 0x02BF; }
  bool is_motor() const { return product == 0x02B0; }
  bool is_audio() const { return product == 0x02AD || product == 0x02BB || product == 0x02BE; }
};

/// What an isochronous endpoint sent in a microframe.
struct IsoPacket {
  std::chrono::steady_clock::time_point time = {};  ///< arrival of its transfer
  std::uint16_t status = 0;                         ///< a libusb_transfer_status; 0: completed
  std::span<const std::uint8_t> data = {};  ///< empty if the microframe had no packet, or it failed
};

/// The parts of all Kinects that are plugged in, by bus and address.
/// @throws Error "sensor-missing"  if USB cannot be used
std::vector<UsbPart> usb_parts();

/// An opened part of a Kinect. All waits have ends: a device that hangs does not hang its thread.
/// It is used by one thread at a time.
class UsbDevice {
 public:
  /// @throws Error "sensor-missing"  if it cannot be opened
  explicit UsbDevice(const UsbPart& part);
  ~UsbDevice();
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  /// The serial number that the device tells; empty if it tells none, or only zeros.
  std::string serial() const;

  /// Sends a vendor request, or receives the reply to one.
  /// @return bytes transferred; negative, an error of libusb, if the transfer failed
  /// @throws Error "sensor-lost"  if the device is gone
  int write(std::uint8_t request, std::span<const std::uint8_t> data,
            std::chrono::milliseconds timeout);
  int read(std::uint8_t request, std::span<std::uint8_t> data, std::chrono::milliseconds timeout);

  /// Begins to read an isochronous endpoint.
  /// @param on_packet  called by `handle_events` for each microframe
  /// @throws Error "sensor-lost"  if the device is gone
  void begin_stream(std::uint8_t endpoint, std::function<void(const IsoPacket&)> on_packet);

  /// Waits for packets. @return false if the stream is over: the device is gone
  bool handle_events();

  /// Ends the stream, within half a second.
  /// @return false if the device did not let go of it, and must be opened again
  bool end_stream();

 private:
  struct ContextEnd {
    void operator()(libusb_context* context) const { libusb_exit(context); }
  };
  struct HandleEnd {
    void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
  };
  struct TransferEnd {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  struct Transfer {
    std::vector<std::uint8_t> buffer = {};
    std::unique_ptr<libusb_transfer, TransferEnd> transfer = {};
  };

  friend std::vector<UsbPart> usb_parts();
  static std::unique_ptr<libusb_context, ContextEnd> make_context();

  int control(std::uint8_t type, std::uint8_t request, std::span<std::uint8_t> data,
              std::chrono::milliseconds timeout);
  void take(libusb_transfer& transfer);

  // Destroyed in reverse: closing the device ends transfers that it has not given back.
  std::unique_ptr<libusb_context, ContextEnd> context_;
  std::vector<Transfer> transfers_ = {};
  std::unique_ptr<libusb_device_handle, HandleEnd> handle_;
  std::function<void(const IsoPacket&)> on_packet_ = {};
  int in_flight_ = 0;  // transfers that the device has
  bool ends_ = false;  // the stream is being ended
};

}  // namespace octurn
