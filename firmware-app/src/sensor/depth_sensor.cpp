#include "sensor/depth_sensor.hpp"

#include <filesystem>
#include <system_error>

#include "octurn/error.hpp"
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

std::optional<Picture> DepthSensor::read_infrared(const std::stop_token& /*stop*/) {
  throw Error(ErrorCode::sensor_other, name() + ": shows no infrared pictures",
              "A printed board is for a Kinect v1, or for a camera with lasers.");
}

void DepthSensor::show_board(int /*hold*/) {}

void DepthSensor::show_wall(std::optional<double> /*distance*/) {}

void DepthSensor::set_object_pose(int /*pose*/) {}

bool is_simulated_sensor(const std::string& uri) { return uri.starts_with(simulator_scheme); }

}  // namespace octurn
