// Octurn's simulated Kinect as an OpenNI2 driver. It announces no device when OpenNI2 starts, so
// that real sensors are found first: a simulated one exists once it is opened by its URI (see
// simulation.hpp).

#include <cmath>
#include <string>

#include "depth_driver.hpp"
#include "property.hpp"
#include "rig/nominal_pose.hpp"
#include "rig/simulation.hpp"
#include "simulator/placed_object.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_stream.hpp"

namespace octurn {
namespace {

Scene make_scene(const Simulation& simulation) {
  const SensorOptics optics = optics_of_unit(simulation.unit);
  if (simulation.wall) {
    return Scene::of_wall(*simulation.wall, optics);
  }
  const Eigen::Isometry3d pose = misaligned_platform_from_sensor(simulation.misalignment);
  return Scene(told_object(simulation.mesh_file), pose, optics);
}

/// The serial number identifies the sensor's fixed pattern, which the seed determines, and its
/// optics.
std::string make_serial(const Simulation& simulation) {
  const std::string serial =
      "simulated-" + std::to_string(simulation.seed) +
      (simulation.unit > 0 ? "-unit-" + std::to_string(simulation.unit) : std::string());
  return simulation.pattern > 0 ? serial : serial + "-perfect";
}

class Device final : public DepthDevice {
 public:
  explicit Device(const Simulation& simulation)
      : simulation_(simulation),
        kinect_(make_scene(simulation), simulation.seed, simulation.noise, simulation.pattern) {}

  OniBool isPropertySupported(int property) override {
    return property == ONI_DEVICE_PROPERTY_ERROR_STATE || property == platform_angle_property ||
                   property == wall_property || property == object_pose_property ||
                   property == board_property || property == sensor_time_property ||
                   property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER
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
    if (property == sensor_time_property) {
      constexpr double frames_per_second = DepthStream::video_mode.fps;
      return give_property(state_.periods / frames_per_second, data, size);
    }
    if (property == ONI_DEVICE_PROPERTY_SERIAL_NUMBER) {
      return give_text(make_serial(simulation_), data, size);
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }

  OniStatus setProperty(int property, const void* data, int size) override {
    if (property != platform_angle_property && property != wall_property &&
        property != object_pose_property && property != board_property) {
      return ONI_STATUS_NOT_SUPPORTED;
    }
    double value = 0;
    const OniStatus status = take_property(value, data, size);
    if (status != ONI_STATUS_OK || !std::isfinite(value) ||
        (property == wall_property && value < 0) ||
        (property == object_pose_property && !(value >= 0 && value <= max_object_pose)) ||
        (property == board_property && !(value >= 0 && value <= max_board_hold))) {
      return ONI_STATUS_BAD_PARAMETER;
    }
    if (property == platform_angle_property) {
      state_.angle = value;
    } else if (property == object_pose_property) {
      state_.object_pose = static_cast<int>(value);
    } else if (property == board_property) {
      state_.board = static_cast<int>(value);
    } else if (!simulation_.wall) {
      state_.wall = value;
    }
    return ONI_STATUS_OK;
  }

 private:
  std::unique_ptr<DepthStream> create_depth_stream() override {
    return std::make_unique<SimulatorStream>(simulation_, kinect_, state_);
  }

  std::unique_ptr<InfraredStream> create_infrared_stream() override {
    return std::make_unique<SimulatorInfraredStream>(simulation_, kinect_, state_);
  }

  bool has_infrared_stream() const override { return true; }

  Simulation simulation_;
  SimulatedKinect kinect_;
  DeviceState state_;
};

class Driver final : public DepthDriver {
 public:
  explicit Driver(OniDriverServices* services)
      : DepthDriver(services, simulator_scheme, "Kinect v1 (simulated)") {}

 private:
  std::unique_ptr<DepthDevice> open(std::string_view uri) override {
    return std::make_unique<Device>(parse_simulation(uri));
  }
};

}  // namespace
}  // namespace octurn

ONI_EXPORT_DRIVER(octurn::Driver)
