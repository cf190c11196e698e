#pragma once

#include <new>

// OpenNI2's header for drivers expects these two from a library that Debian does not package.
#define XN_NEW(type, argument) new (std::nothrow) type(argument)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "sensor_stream.hpp"

namespace octurn {

/// A device with a depth sensor, and perhaps the infrared camera behind it.
class DepthDevice : public oni::driver::DeviceBase {
 public:
  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override;
  oni::driver::StreamBase* createStream(OniSensorType type) override;
  void destroyStream(oni::driver::StreamBase* stream) override;

 protected:
  virtual std::unique_ptr<DepthStream> create_depth_stream() = 0;

  /// Returns null if the device shows no infrared pictures.
  virtual std::unique_ptr<InfraredStream> create_infrared_stream() { return nullptr; }
  virtual bool has_infrared_stream() const { return false; }

 private:
  OniVideoMode depth_mode_ = DepthStream::video_mode;
  OniVideoMode infrared_mode_ = InfraredStream::video_mode;
  std::array<OniSensorInfo, 2> sensors_ = {
      {{ONI_SENSOR_DEPTH, 1, &depth_mode_}, {ONI_SENSOR_IR, 1, &infrared_mode_}}};
};

/// A driver of the devices whose URIs begin with one scheme. It has no thread that watches for
/// devices: OpenNI2's shutdown would wait for that thread for ever.
class DepthDriver : public oni::driver::DriverBase {
 public:
  /// @param device_name  the name of every device
  DepthDriver(OniDriverServices* services, std::string_view scheme, std::string_view device_name)
      : DriverBase(services), scheme_(scheme), device_name_(device_name) {}

  /// Accepts every URI of its scheme, even one that `open` will refuse: OpenNI2 passes on the
  /// errors of `open` alone.
  OniStatus tryDevice(const char* uri) override;

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* mode) override;
  void deviceClose(oni::driver::DeviceBase* device) override;
  void shutdown() override {}

 protected:
  /// @throws std::exception  that says why it cannot
  virtual std::unique_ptr<DepthDevice> open(std::string_view uri) = 0;

  /// Puts a device on OpenNI2's list.
  void announce(std::string_view uri);

 private:
  std::string scheme_;
  std::string device_name_;
};

}  // namespace octurn
