// Octurn's driver for the Kinect v1 as OpenNI2 loads it: models 1414, 1473 and Kinect for Windows.
// It looks for Kinects when OpenNI2 starts, and again whenever one is opened by its URI.

#include <algorithm>
#include <charconv>
#include <span>
#include <string>

#include "depth_driver.hpp"
#include "kinect/kinect.hpp"
#include "kinect/kinect_stream.hpp"
#include "octurn/error.hpp"
#include "property.hpp"
#include "rig/kinect_device.hpp"

namespace octurn {
namespace {

int index_in(std::string_view uri) {
  const std::string_view number = uri.substr(kinect_scheme.size());
  int index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  if (!number.empty() &&
      (error != std::errc() || end != number.data() + number.size() || index < 0)) {
    throw Error(ErrorCode::sensor_missing,
                "kinect: \"" + std::string(number) + "\" is no number of a Kinect");
  }
  return index;
}

class Device final : public DepthDevice {
 public:
  Device(int index, oni::driver::DriverServices& services) : kinect_(index), services_(services) {}

  OniBool isPropertySupported(int property) override {
    switch (property) {
      case ONI_DEVICE_PROPERTY_ERROR_STATE:
      case packet_counts_property:
      case usb_log_property:
        return TRUE;
      case ONI_DEVICE_PROPERTY_SERIAL_NUMBER:
        return kinect_.serial().empty() ? FALSE : TRUE;
      case tilt_property:
        return kinect_.tilt() ? TRUE : FALSE;
      case near_mode_property:
        return kinect_.has_near_mode() ? TRUE : FALSE;
      default:
        return FALSE;
    }
  }

  OniStatus getProperty(int property, void* data, int* size) override {
    if (property == ONI_DEVICE_PROPERTY_ERROR_STATE) {
      const int state = kinect_.is_lost() ? ONI_DEVICE_STATE_ERROR : ONI_DEVICE_STATE_OK;
      return give_property(state, data, size);
    }
    if (property == tilt_property) {
      const std::optional<Tilt> tilt = kinect_.tilt();
      return tilt ? give_property(*tilt, data, size) : ONI_STATUS_NOT_SUPPORTED;
    }
    if (property == packet_counts_property) {
      return give_property(kinect_.packet_counts(), data, size);
    }
    if (property == usb_log_property) {
      const std::span packets(static_cast<UsbPacket*>(data),
                              static_cast<std::size_t>(*size) / sizeof(UsbPacket));
      *size = static_cast<int>(kinect_.take_logged(packets) * sizeof(UsbPacket));
      return ONI_STATUS_OK;
    }
    if (property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER && !kinect_.serial().empty()) {
      return give_text(kinect_.serial(), data, size);
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }

  OniStatus setProperty(int property, const void* data, int size) override {
    if (property == usb_log_property) {
      int count = 0;
      const OniStatus status = take_property(count, data, size);
      if (status == ONI_STATUS_OK) {
        kinect_.log_packets(
            std::min(static_cast<std::size_t>(std::max(count, 0)), max_logged_packets));
      }
      return status;
    }
    if (property != near_mode_property || !kinect_.has_near_mode()) {
      return ONI_STATUS_NOT_SUPPORTED;
    }
    OniBool on = FALSE;
    const OniStatus status = take_property(on, data, size);
    if (status != ONI_STATUS_OK) {
      return status;
    }
    return kinect_.set_near_mode(on != FALSE) ? ONI_STATUS_OK : ONI_STATUS_ERROR;
  }

 private:
  std::unique_ptr<DepthStream> create_depth_stream() override {
    return std::make_unique<KinectDepthStream>(kinect_, services_);
  }
  std::unique_ptr<InfraredStream> create_infrared_stream() override {
    return std::make_unique<KinectInfraredStream>(kinect_, services_);
  }
  bool has_infrared_stream() const override { return true; }

  Kinect kinect_;
  oni::driver::DriverServices& services_;
};

class Driver final : public DepthDriver {
 public:
  explicit Driver(OniDriverServices* services)
      : DepthDriver(services, kinect_scheme, "Kinect v1") {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    try {
      const int count = Kinect::count();
      for (int index = 0; index < count; ++index) {
        announce(std::string(kinect_scheme) + std::to_string(index));
      }
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
    }
    return ONI_STATUS_OK;
  }

 private:
  std::unique_ptr<DepthDevice> open(std::string_view uri) override {
    return std::make_unique<Device>(index_in(uri), getServices());
  }
};

}  // namespace
}  // namespace octurn

ONI_EXPORT_DRIVER(octurn::Driver)
