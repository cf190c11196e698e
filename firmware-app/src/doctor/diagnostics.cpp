#include "doctor/diagnostics.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "calibration/calibration_store.hpp"
#include "calibration/optics_files.hpp"
#include "doctor/machine_checks.hpp"
#include "octurn/error.hpp"
#include "sensor/depth_sensor.hpp"
#include "store/data_folder.hpp"
#include "store/job_file.hpp"
#include "turntable/gpio_chip.hpp"
#include "version.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t max_system_file_bytes = std::size_t{16} << 10U;  // of each system file
constexpr std::size_t max_scans_bytes = std::size_t{1} << 20U;         // of scans.json

// None of these identifies a machine: no serial number, address or host name.
constexpr std::array system_files{
    "etc/os-release",
    "proc/device-tree/model",
    "proc/version",
    "proc/uptime",
    "proc/loadavg",
    "proc/meminfo",
    "proc/self/status",
    "proc/modules",
    "sys/devices/platform/soc/soc:firmware/get_throttled",
};

struct DeviceFile {
  const char* folder;
  const char* name;
};
constexpr std::array device_files{
    DeviceFile{"sys/class/thermal", "type"},
    DeviceFile{"sys/class/thermal", "temp"},
    DeviceFile{"sys/class/hwmon", "name"},
    DeviceFile{"sys/class/hwmon", "in0_lcrit_alarm"},
    DeviceFile{"sys/bus/usb/devices", "idVendor"},
    DeviceFile{"sys/bus/usb/devices", "idProduct"},
    DeviceFile{"sys/bus/usb/devices", "bcdDevice"},
    DeviceFile{"sys/bus/usb/devices", "product"},
    DeviceFile{"sys/bus/usb/devices", "speed"},
};

ArchivedFile json_file(std::string name, const json& content) {
  return {.name = std::move(name),
          .content = content.dump(1, ' ', false, json::error_handler_t::replace) + "\n"};
}

/// Paths of the shared libraries that this process has loaded, with links resolved: most file names
/// then end with a version.
std::set<std::string> loaded_libraries(const fs::path& root) {
  std::set<std::string> libraries;
  std::ifstream maps(root / "proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t path = line.find('/');
    if (path != line.npos && line.find(".so", path) != line.npos) {
      libraries.insert(line.substr(path));
    }
  }
  return libraries;
}

json versions(const fs::path& root) {
  utsname kernel{};
  ::uname(&kernel);
  return {{"octurn", version()},
          {"openni2", openni_version()},
          {"libgpiod", gpiod_version()},
          {"libraries", loaded_libraries(root)},
          {"kernel", std::string(kernel.sysname) + " " + kernel.release},
          {"machine", kernel.machine}};
}

/// Appends the beginning of a file under a headline, as `head` does for several files.
void append_file(std::string& text, const fs::path& root, const fs::path& file) {
  std::string content(max_system_file_bytes, '\0');
  std::ifstream stream(root / file, std::ios::binary);
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  std::erase(content, '\0');  // strings of the device tree end with it
  if (!content.empty()) {
    text.append("==> /").append(file.string()).append(" <==\n").append(content);
    text.append(content.ends_with('\n') ? "\n" : "\n\n");
  }
}

std::string system_text(const fs::path& root) {
  std::string text;
  for (const char* const file : system_files) {
    append_file(text, root, file);
  }
  for (const auto& [folder, name] : device_files) {
    for (const fs::path& device : entries(root / folder)) {
      append_file(text, root, fs::path(folder) / device.filename() / name);
    }
  }
  return text;
}

/// The newest scans that fit into `max_scans_bytes`.
json scans_without_names(std::span<const Job> scans) {
  json all = json::array();
  std::size_t bytes = 0;
  for (const Job& job : scans) {
    json scan = to_job_json(job);
    scan.erase("name");
    bytes += scan.dump(1, ' ', false, json::error_handler_t::replace).size();
    if (bytes > max_scans_bytes) {
      break;
    }
    all.push_back(std::move(scan));
  }
  const std::size_t left_out = scans.size() - all.size();
  return {{"scans", std::move(all)}, {"left_out", left_out}};
}

/// @return nothing if the folder is no scan's, or damaged
std::optional<Job> readable_job(const fs::path& folder) try {
  return read_job(folder);
} catch (const Error&) {
  return std::nullopt;
}

/// The scans that can be read, the newest first: their folders are named by their times.
std::vector<Job> stored_scans(const fs::path& data) {
  std::vector<std::string> ids = names_in(data / "scans");
  std::ranges::sort(ids, std::greater<>());
  std::vector<Job> scans;
  for (const std::string& id : ids) {
    if (std::optional<Job> job = readable_job(data / "scans" / id)) {
      scans.push_back(*std::move(job));
    }
  }
  return scans;
}

/// A sensor's optics, the newest first; null if their file is damaged.
json optics_records(const fs::path& data, const std::string& serial) try {
  json records = json::array();
  for (const OpticsRecord& record : read_optics(data, serial)) {
    records.push_back(to_json(record));
  }
  return records;
} catch (const Error&) {
  return nullptr;
}

/// Those of each sensor, without the serial numbers by which they are stored.
json all_optics(const fs::path& data) {
  json sensors = json::array();
  for (const fs::path& file : entries(data / "optics")) {
    sensors.push_back(optics_records(data, file.stem().string()));
  }
  return sensors;
}

}  // namespace

std::vector<ArchivedFile> machine_diagnostics(const Config& config,
                                              std::span<const Finding> findings,
                                              const fs::path& root) {
  return {json_file("versions.json", versions(root)),
          json_file("settings.json", to_json(config)),
          json_file("doctor.json", to_json(findings)),
          {.name = "system.txt", .content = system_text(root)}};
}

ArchivedFile calibration_diagnostics(const Config& config) {
  json poses = json::array();
  for (const PoseRecord& record :
       CalibrationStore(config.data, config.sensor).records(config.scan)) {
    json pose = to_json(record);
    for (const char* const serial : {"camera", "optics_of"}) {
      pose.erase(serial);
    }
    poses.push_back(std::move(pose));
  }
  return json_file("calibration.json",
                   {{"poses", std::move(poses)}, {"optics", all_optics(config.data)}});
}

ArchivedFile scan_diagnostics(const fs::path& data) {
  return json_file("scans.json", scans_without_names(stored_scans(data)));
}

std::vector<ArchivedFile> daemon_diagnostics(const Status& status, std::span<const Job> scans,
                                             std::string log) {
  return {json_file("devices.json",
                    {{"sensor", to_json(status.sensor)}, {"turntable", to_json(status.turntable)}}),
          json_file("scans.json", scans_without_names(scans)),
          {.name = "log.txt", .content = std::move(log)}};
}

std::vector<ArchivedFile> appliance_diagnostics(const Appliance& appliance) {
  std::string errors = appliance.errors();
  return errors.empty() ? std::vector<ArchivedFile>{}
                        : std::vector{ArchivedFile{.name = "errors.txt", .content = errors}};
}

}  // namespace octurn
