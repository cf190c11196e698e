#include "depth_driver.hpp"

#include <exception>

namespace octurn {

OniStatus DepthDevice::getSensorInfoList(OniSensorInfo** infos, int* count) {
  *infos = sensors_.data();
  *count = has_infrared_stream() ? 2 : 1;
  return ONI_STATUS_OK;
}

oni::driver::StreamBase* DepthDevice::createStream(OniSensorType type) {
  if (type == ONI_SENSOR_IR) {
    return create_infrared_stream().release();
  }
  return type == ONI_SENSOR_DEPTH ? create_depth_stream().release() : nullptr;
}

void DepthDevice::destroyStream(oni::driver::StreamBase* stream) {
  const std::unique_ptr<oni::driver::StreamBase> owned(stream);
}

OniStatus DepthDriver::tryDevice(const char* uri) {
  if (!std::string_view(uri).starts_with(scheme_)) {
    return ONI_STATUS_ERROR;
  }
  announce(uri);
  return ONI_STATUS_OK;
}

void DepthDriver::announce(std::string_view uri) {
  OniDeviceInfo info = {};
  uri.copy(info.uri, sizeof info.uri - 1);
  std::string_view("Octurn").copy(info.vendor, sizeof info.vendor - 1);
  device_name_.copy(info.name, sizeof info.name - 1);
  deviceConnected(&info);
}

oni::driver::DeviceBase* DepthDriver::deviceOpen(const char* uri, const char* /*mode*/) {
  try {
    return open(uri).release();
  } catch (const std::exception& error) {
    getServices().errorLoggerAppend("%s", error.what());
    return nullptr;
  }
}

void DepthDriver::deviceClose(oni::driver::DeviceBase* device) {
  const std::unique_ptr<oni::driver::DeviceBase> owned(device);
}

}  // namespace octurn
