#pragma once

#include <vector>

#include "rig/usb_log.hpp"

namespace octurn {

/// A depth sensor whose packets on USB can be logged: a Kinect.
class PacketLogger {
 public:
  PacketLogger() = default;
  virtual ~PacketLogger() = default;
  PacketLogger(const PacketLogger&) = delete;
  PacketLogger& operator=(const PacketLogger&) = delete;

  /// Logs the packets that come next, at most `count`. @return false if this sensor cannot
  virtual bool log_packets(int count) = 0;

  virtual std::vector<UsbPacket> take_logged_packets() = 0;
};

}  // namespace octurn
