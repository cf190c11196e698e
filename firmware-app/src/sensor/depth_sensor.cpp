#include "sensor/depth_sensor.hpp"

#include <filesystem>
#include <system_error>

#include "rig/simulation.hpp"

namespace octurn {

std::unique_ptr<DepthSensor> open_sensor(const std::string& uri) {
  std::error_code unreadable;  // OpenNI2 then says that there is no such device
  if (std::filesystem::is_directory(uri, unreadable)) {
    return open_recording(uri);
  }
  return std::filesystem::is_regular_file(uri, unreadable) ? open_oni_file(uri)
                                                           : open_openni_sensor(uri);
}

void DepthSensor::show_wall(std::optional<double> /*distance*/) {}

void DepthSensor::set_object_pose(int /*pose*/) {}

bool is_simulated_sensor(const std::string& uri) { return uri.starts_with(simulator_scheme); }

}  // namespace octurn
