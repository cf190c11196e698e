#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "file_descriptor.hpp"
#include "kinect/emulated/camera.hpp"
#include "kinect/emulated/emulated_kinect.hpp"
#include "kinect/emulated/usb_parts.hpp"

namespace octurn {

/// A USB device of an emulated Kinect at its end of a USB/IP connection, from where a real one's
/// server has been asked for it: what follows is a USB bus as messages (Linux,
/// Documentation/usb/usbip_protocol.rst). At the other end is the kernel's vhci_hcd, above which
/// everything is as with a real Kinect.
class UsbipDevice {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param socket  a stream; the device is plugged in as long as it is open at both ends
  UsbipDevice(KinectPart part, EmulatedKinect& kinect, Camera& camera, FileDescriptor socket)
      : part_(part), kinect_(kinect), camera_(camera), socket_(std::move(socket)) {}

  int socket() const { return socket_.number(); }

  /// Takes one message, and waits until it is whole. Control transfers are answered at once.
  /// @return false if the other end has gone, or sent what is no message
  bool take_message();

  /// When the isochronous transfer that waits longest is over; nothing if none waits. A frame takes
  /// 1/30 s over the Kinect's speed. A machine that is too busy gets its frames later, and whole:
  /// only tests decide what is lost.
  std::optional<Clock::time_point> due() const;

  /// Gives that transfer back: with what came on the depth endpoint, or on the other one, nothing.
  /// @return false if the other end has gone
  bool complete(Clock::time_point now);

 private:
  /// An isochronous transfer that waits for its time.
  struct Transfer {
    std::uint32_t sequence = 0;
    std::uint32_t endpoint = 0;
    std::vector<std::uint32_t> packet_bytes = {};  // room for each packet
    Clock::time_point due = {};
  };

  bool take_transfer(std::span<const std::uint8_t> header);
  bool unlink(std::uint32_t sequence, std::uint32_t unlinked);
  bool answer_control(std::uint32_t sequence, const UsbSetup& setup,
                      std::vector<std::uint8_t> data);
  bool send(std::span<const std::uint8_t> bytes);

  KinectPart part_;
  EmulatedKinect& kinect_;
  Camera& camera_;
  FileDescriptor socket_;
  std::deque<Transfer> waiting_ = {};
  Clock::time_point over_ = {};  // the last of the transfers before
};

}  // namespace octurn
