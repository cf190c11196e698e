#include "sensor/openni_library.hpp"

#include "octurn/error.hpp"
#include "rig/kinect_device.hpp"
#include "rig/simulation.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {
namespace {

constexpr const char* simulation_hint =
    "Check the simulator's settings, and that its mesh is an STL file in millimetres.";

/// OpenNI2 copies the URI into its error text, and overflows that buffer of 1,024 bytes.
constexpr std::size_t max_uri_length = 512;

/// URI of the first sensor on OpenNI2's list, which is filled when OpenNI2 starts; else of any
/// Kinect, which may have been plugged in since. Skips simulated sensors: once opened, they stay on
/// the list.
std::string any_sensor() {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  for (int i = 0; i < devices.getSize(); ++i) {
    std::string uri = devices[i].getUri();
    if (!is_simulated_sensor(uri)) {
      return uri;
    }
  }
  return std::string(kinect_scheme);
}

}  // namespace

std::string openni_error_text() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& letter : text) {
    letter = letter == '\n' || letter == '\t' ? ' ' : letter;
  }
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

void expect_ok(openni::Status status, const char* doing) {
  if (status != openni::STATUS_OK) {
    throw Error(ErrorCode::sensor_failed,
                std::string("sensor: cannot ") + doing + ": " + openni_error_text(),
                "Unplug the sensor, plug it in again, and retry.");
  }
}

void open_device(openni::Device& device, const std::string& uri) {
  if (uri.size() > max_uri_length) {
    throw Error(ErrorCode::sensor_missing,
                "sensor: an address of more than " + std::to_string(max_uri_length) +
                    " bytes: " + uri.substr(0, 40) + "...",
                missing_sensor_hint);
  }
  if (device.open((uri.empty() ? any_sensor() : uri).c_str()) == openni::STATUS_OK) {
    return;
  }
  if (is_simulated_sensor(uri)) {
    throw Error(ErrorCode::sensor_failed, "sensor: " + openni_error_text(), simulation_hint);
  }
  throw Error(ErrorCode::sensor_missing,
              (uri.empty() ? "no sensor was found: " : "sensor: ") + openni_error_text(),
              missing_sensor_hint);
}

/// Loading changes the working directory of the process for a moment. The drivers are never
/// unloaded: PSLink and PS1080, which come with OpenNI2, cancel their threads, and unloading unmaps
/// the code that these still run. Some exits of the program crashed by that (SIGSEGV).
void load_sensor_drivers() {
  [[maybe_unused]] static const bool loaded = [] {
    expect_ok(openni::OpenNI::initialize(), "load OpenNI2's drivers");
    return true;
  }();
}

std::string openni_version() {
  const openni::Version version = openni::OpenNI::getVersion();
  return std::to_string(version.major) + "." + std::to_string(version.minor) + "." +
         std::to_string(version.maintenance) + "." + std::to_string(version.build);
}

}  // namespace octurn
