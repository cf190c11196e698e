// Octurn's simulated Kinect as an OpenNI2 driver. Nothing is announced when OpenNI2 starts, so that
// real sensors are found first; a simulated one is there when it is opened by its URI (see
// simulation.hpp).

#include <new>

// OpenNI2's header for drivers takes these two from a library that is not packaged.
#define XN_NEW(type, argument) new (std::nothrow) type(argument)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include <cmath>
#include <exception>
#include <memory>
#include <string_view>

#include "simulator/depth_stream.hpp"
#include "simulator/mesh_file.hpp"
#include "simulator/property.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulation.hpp"
#include "simulator/simulator_object.hpp"
#include "simulator/surface_net.hpp"

namespace octurn {
namespace {

Mesh object_of(const Simulation& simulation) {
  if (!simulation.mesh_file.empty()) {
    Mesh mesh = read_mesh(simulation.mesh_file);
    stand_on_platform(mesh);
    return mesh;
  }
  constexpr double cell = 0.00125;  // metres, about a pixel
  return surface_net(simulator_object_distance, simulator_object_bounds(), cell);
}

class Device final : public oni::driver::DeviceBase {
 public:
  explicit Device(const Simulation& simulation)
      : simulation_(simulation),
        kinect_(object_of(simulation), simulation.seed, simulation.noise) {}

  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
    *infos = &sensor_;
    *count = 1;
    return ONI_STATUS_OK;
  }

  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return type == ONI_SENSOR_DEPTH
               ? std::make_unique<DepthStream>(simulation_, kinect_, state_).release()
               : nullptr;
  }

  void destroyStream(oni::driver::StreamBase* stream) override {
    const std::unique_ptr<oni::driver::StreamBase> owned(stream);
  }

  OniBool isPropertySupported(int property) override {
    return property == ONI_DEVICE_PROPERTY_ERROR_STATE || property == platform_angle_property
               ? TRUE
               : FALSE;
  }

  OniStatus getProperty(int property, void* data, int* size) override {
    if (property == ONI_DEVICE_PROPERTY_ERROR_STATE) {
      const int state = state_.is_lost ? ONI_DEVICE_STATE_ERROR : ONI_DEVICE_STATE_OK;
      return give_property(state, data, size);
    }
    if (property == platform_angle_property) {
      return give_property(state_.angle.load(), data, size);
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }

  OniStatus setProperty(int property, const void* data, int size) override {
    if (property != platform_angle_property) {
      return ONI_STATUS_NOT_SUPPORTED;
    }
    double angle = 0;
    const OniStatus status = take_property(angle, data, size);
    if (status != ONI_STATUS_OK || !std::isfinite(angle)) {
      return ONI_STATUS_BAD_PARAMETER;
    }
    state_.angle = angle;
    return ONI_STATUS_OK;
  }

 private:
  Simulation simulation_;
  SimulatedKinect kinect_;
  DeviceState state_;
  OniVideoMode mode_ = DepthStream::video_mode;
  OniSensorInfo sensor_ = {ONI_SENSOR_DEPTH, 1, &mode_};
};

class Driver final : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}

  /// Takes every URI of its scheme, also one that deviceOpen will refuse: only its reasons are
  /// heard.
  OniStatus tryDevice(const char* uri) override {
    if (!std::string_view(uri).starts_with(simulator_scheme)) {
      return ONI_STATUS_ERROR;
    }
    OniDeviceInfo info = {};
    std::string_view(uri).copy(info.uri, sizeof info.uri - 1);
    std::string_view("Octurn").copy(info.vendor, sizeof info.vendor - 1);
    std::string_view("Kinect v1 (simulated)").copy(info.name, sizeof info.name - 1);
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    try {
      return std::make_unique<Device>(parse_simulation(uri)).release();
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
      return nullptr;
    }
  }

  void deviceClose(oni::driver::DeviceBase* device) override {
    const std::unique_ptr<oni::driver::DeviceBase> owned(device);
  }

  void shutdown() override {}
};

}  // namespace
}  // namespace octurn

ONI_EXPORT_DRIVER(octurn::Driver)
