// Emulates a Kinect v1 on the USB of the machine on which it runs: it attaches the device to the
// kernel's vhci_hcd by USB/IP and renders its view at a platform angle that a peer reports. Kernel,
// libusb and Octurn's driver above it are the real ones. Needs root, and the kernel
// module vhci-hcd.
//
// Before each frame it sends the line "look" to ADDRESS PORT and waits for "angle RADIANS", the
// platform's angle, counter-clockwise seen from above. So each frame shows the effect of all pulses
// before it. Other lines from the peer are orders, each answered by "ok" or an error text:
//
//   plug, unplug              attaches or detaches the Kinect
//   frames                    answered by the numbers so far, "SENT DAMAGED"
//   delays                    answered by those of the USB's transfers until they are submitted
//                             again, since the last such order: "COUNT HALF NINETY_NINE LONGEST",
//                             in us, where HALF and 99 of 100 took at most so long
//   speed FACTOR              sets the frame rate as a multiple of 30 a second
//   lose PERIOD FIRST COUNT   drops COUNT packets from FIRST on in every PERIOD-th frame; 1 0 0:
//   none
//   drop SHARE                drops packets at random, so many of them all; 0: none

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <deque>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "file_descriptor.hpp"
#include "kinect/emulated/usbip_device.hpp"
#include "simulator/camera.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_object.hpp"

namespace octurn {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The connection to the peer that knows the platform's angle.
class Control {
 public:
  /// @param address  IPv4, dotted decimal
  Control(const char* address, const char* port) {
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
    if (::inet_pton(AF_INET, address, &to.sin_addr) != 1) {
      throw std::runtime_error(std::string(address) + " is no address");
    }
    connection_ = FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const int now = 1;
    if (!connection_.is_open() ||
        ::connect(connection_.number(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
        ::setsockopt(connection_.number(), IPPROTO_TCP, TCP_NODELAY, &now, sizeof now) != 0) {
      fail(std::string(address) + " " + port);
    }
  }

  int number() const { return connection_.number(); }

  void send(const std::string& line) {
    const std::string text = line + "\n";
    if (::send(number(), text.data(), text.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(text.size())) {
      fail("send");
    }
  }

  /// Reads from the connection; blocks until there is data. @throws std::runtime_error  if it is
  /// closed
  void receive() {
    std::array<char, 4096> buffer = {};
    const ssize_t count = ::recv(number(), buffer.data(), buffer.size(), 0);
    if (count <= 0) {
      throw std::runtime_error("nobody is there any more");
    }
    text_.append(buffer.data(), static_cast<std::size_t>(count));
    for (auto end = text_.find('\n'); end != text_.npos; end = text_.find('\n')) {
      lines_.push_back(text_.substr(0, end));
      text_.erase(0, end + 1);
    }
  }

  /// The next received order, if any.
  std::optional<std::string> take_order() {
    if (lines_.empty()) {
      return std::nullopt;
    }
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }

  /// Asks for the platform's current angle. Orders that arrive before the answer are queued.
  double ask_angle() {
    constexpr std::string_view answer = "angle ";
    send("look");
    for (;;) {
      const auto found = std::ranges::find_if(
          lines_, [&](const std::string& line) { return line.starts_with(answer); });
      if (found != lines_.end()) {
        const double angle = std::stod(found->substr(answer.size()));
        lines_.erase(found);
        return angle;
      }
      receive();
    }
  }

 private:
  FileDescriptor connection_;
  std::string text_;
  std::deque<std::string> lines_;
};

/// The simulated Kinect's view as raw readings.
class View {
 public:
  View() : kinect_(Scene(simulator_object()), 1, 1, 1) {
    const std::vector<std::uint16_t> depths = depth_of_readings();
    for (std::size_t reading = 0; reading < no_reading; ++reading) {
      reading_of_depth_[depths[reading]] = static_cast<std::uint16_t>(reading);
    }
    reading_of_depth_[0] = no_reading;
  }

  std::span<const std::uint16_t> readings(double angle, int frame) {
    kinect_.expose(angle, static_cast<std::uint32_t>(frame), picture_);
    for (std::uint16_t& pixel : picture_) {
      pixel = reading_of_depth_[pixel];
    }
    return picture_;
  }

 private:
  SimulatedKinect kinect_;
  std::vector<std::uint16_t> reading_of_depth_ = std::vector<std::uint16_t>(65536);
  std::vector<std::uint16_t> picture_ = std::vector<std::uint16_t>(pixels(camera));
};

/// Writes a line to a sysfs file. @return whether the kernel accepted it
bool tell_kernel(const char* file, const std::string& line) {
  const FileDescriptor opened(::open(file, O_WRONLY | O_CLOEXEC));
  if (!opened.is_open()) {
    fail(file);
  }
  return ::write(opened.number(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

/// Attaches a high-speed USB device to a free port, different from the previous device's, whose
/// detachment the kernel may not have noticed yet. @return the device's end of the connection
FileDescriptor plug_into_kernel(unsigned device_number) {
  constexpr const char* attach = "/sys/devices/platform/vhci_hcd.0/attach";
  constexpr unsigned high_speed_ports = 8;
  constexpr int high_speed = 3;  // USB_SPEED_HIGH
  std::array<int, 2> ends = {};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    fail("socketpair");
  }
  FileDescriptor own(ends[0]);
  const FileDescriptor kernels(ends[1]);
  for (unsigned i = 0; i < high_speed_ports; ++i) {
    const unsigned port = (device_number + i) % high_speed_ports;
    if (tell_kernel(attach, std::to_string(port) + " " + std::to_string(kernels.number()) + " " +
                                std::to_string(0x10000 + device_number) + " " +
                                std::to_string(high_speed))) {
      return own;
    }
  }
  fail("no port of vhci_hcd is free");
}

class TwinKinect {
 public:
  explicit TwinKinect(Control& control) : control_(control) {}

  /// Obeys orders until the peer closes the connection.
  void obey_orders() {
    for (;;) {
      while (const auto order = control_.take_order()) {
        control_.send(obey(*order));
      }
      serve();
    }
  }

 private:
  void plug() {
    for (const KinectPart part : {KinectPart::camera, KinectPart::motor}) {
      devices_.push_back(std::make_unique<UsbipDevice>(part, kinect_, camera_,
                                                       plug_into_kernel(++device_number_)));
    }
  }
  void unplug() { devices_.clear(); }

  /// @return the answer
  std::string obey(const std::string& order) {
    std::istringstream words(order);
    std::string verb;
    words >> verb;
    if (verb == "plug") {
      plug();
    } else if (verb == "unplug") {
      unplug();
    } else if (verb == "speed") {
      double factor = 1;
      words >> factor;
      kinect_.speed = factor;
    } else if (verb == "lose") {
      int period = 1;
      int first = 0;
      int count = 0;
      words >> period >> first >> count;
      kinect_.loss_period = period;
      kinect_.first_lost = first;
      kinect_.lost_packets = count;
    } else if (verb == "drop") {
      double share = 0;
      words >> share;
      kinect_.random_loss = share;
    } else if (verb == "frames") {
      return std::to_string(kinect_.frames_sent) + " " + std::to_string(kinect_.frames_damaged);
    } else if (verb == "delays") {
      return delays();
    } else {
      return "there is no such order";
    }
    return words ? "ok" : "a number is missing";
  }

  std::string delays() {
    std::vector<UsbipDevice::Clock::duration> all;
    for (const auto& device : devices_) {
      std::ranges::copy(device->take_delays(), std::back_inserter(all));
    }
    std::ranges::sort(all);
    std::string text = std::to_string(all.size());
    for (const std::size_t percent : {50U, 99U, 100U}) {
      const auto delay = all.empty() ? UsbipDevice::Clock::duration::zero()
                                     : all[(all.size() - 1) * percent / 100];
      const auto delay_us = std::chrono::duration_cast<std::chrono::microseconds>(delay);
      text += " " + std::to_string(delay_us.count());
    }
    return text;
  }

  /// Handles pending USB traffic, or waits for more or for an order.
  void serve() {
    std::vector<pollfd> files = {{.fd = control_.number(), .events = POLLIN, .revents = 0}};
    for (const auto& device : devices_) {
      files.push_back({.fd = device->socket(), .events = POLLIN, .revents = 0});
    }
    if (::poll(files.data(), files.size(), patience_ms()) < 0 && errno != EINTR) {
      fail("poll");
    }
    const auto now = UsbipDevice::Clock::now();
    for (std::size_t i = 0; i < devices_.size(); ++i) {
      UsbipDevice& device = *devices_[i];
      const bool is_there = (files[i + 1].revents == 0 || device.take_message()) &&
                            (!device.due() || *device.due() > now || device.complete(now));
      if (!is_there) {
        std::cerr << "the kernel has let go of the Kinect" << std::endl;
        unplug();
      }
    }
    if (files[0].revents != 0) {
      control_.receive();
    }
  }

  int patience_ms() const {
    int patience = 1000;
    for (const auto& device : devices_) {
      if (const auto due = device->due()) {
        const auto left =
            std::chrono::ceil<std::chrono::milliseconds>(*due - UsbipDevice::Clock::now());
        patience = std::clamp(static_cast<int>(left.count()), 0, patience);
      }
    }
    return patience;
  }

  Control& control_;
  View view_;
  EmulatedKinect kinect_;
  EmulatedCamera camera_{kinect_,
                         [this](int frame) { return view_.readings(control_.ask_angle(), frame); }};
  std::vector<std::unique_ptr<UsbipDevice>> devices_;
  unsigned device_number_ = 0;
};

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: kinect ADDRESS PORT" << std::endl;
    return 2;
  }
  try {
    octurn::Control control(argv[1], argv[2]);
    octurn::TwinKinect(control).obey_orders();
  } catch (const std::exception& error) {
    std::cerr << "kinect: " << error.what() << std::endl;
  }
  return 1;
}
