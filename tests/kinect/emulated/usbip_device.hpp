#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "file_descriptor.hpp"
#include "kinect/emulated/camera.hpp"
#include "kinect/emulated/emulated_kinect.hpp"
#include "kinect/emulated/usb_parts.hpp"

namespace octurn {

/// A USB device of an emulated Kinect: the server's side of a USB/IP connection after the import
/// handshake, when USB transfers travel as messages (Linux, Documentation/usb/usbip_protocol.rst).
/// The peer is the kernel's vhci_hcd; all layers above it are those of a real Kinect.
class UsbipDevice {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param socket  a stream socket; the device is plugged in while both ends are open
  UsbipDevice(KinectPart part, EmulatedKinect& kinect, EmulatedCamera& camera,
              FileDescriptor socket)
      : part_(part), kinect_(kinect), camera_(camera), socket_(std::move(socket)) {}

  int socket() const { return socket_.number(); }

  /// Reads one message, and blocks until it is complete. Control transfers are answered at once.
  /// @return false if the peer closed, or sent an invalid message
  bool take_message();

  /// When the oldest pending isochronous transfer is due; nothing if none is pending. A frame takes
  /// 1/30 s divided by the Kinect's speed. A busy machine gets frames late but complete: losses are
  /// up to the tests.
  std::optional<Clock::time_point> due() const;

  /// Completes that transfer with its endpoint's packets.
  /// @return false if the peer closed
  bool complete(Clock::time_point now);

  /// How long after each completed transfer the peer submitted it again, since the last call: what
  /// transfers in flight have to bridge. Those are left out whose submission a frame that was made
  /// meanwhile has kept waiting here.
  std::vector<Clock::duration> take_delays() { return std::exchange(delays_, {}); }

 private:
  /// A pending isochronous transfer.
  struct Transfer {
    std::uint32_t sequence = 0;
    std::uint32_t endpoint = 0;
    std::vector<std::uint32_t> packet_bytes = {};  // capacity of each packet
    Clock::time_point due = {};
  };

  bool take_transfer(std::span<const std::uint8_t> header);
  void count_delay();
  bool unlink(std::uint32_t sequence, std::uint32_t unlinked);
  bool answer_control(std::uint32_t sequence, const UsbSetup& setup,
                      std::vector<std::uint8_t> data);
  bool send(std::span<const std::uint8_t> bytes);

  KinectPart part_;
  EmulatedKinect& kinect_;
  EmulatedCamera& camera_;
  FileDescriptor socket_;
  std::deque<Transfer> waiting_ = {};
  Clock::time_point over_ = {};  // end of the last completed transfer
  std::deque<std::optional<Clock::time_point>> completed_ = {};  // and not submitted again
  std::vector<Clock::duration> delays_ = {};
};

}  // namespace octurn
