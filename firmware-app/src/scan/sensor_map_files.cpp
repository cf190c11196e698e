#include "scan/sensor_map_files.hpp"

#include <cstddef>
#include <optional>
#include <string>

#include "octurn/file.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_map_bytes = 16U << 20U;

constexpr std::string_view allowed =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";

}  // namespace

std::filesystem::path sensor_map_of(const std::filesystem::path& data, std::string_view serial) {
  std::string name(serial);
  for (char& letter : name) {
    letter = allowed.find(letter) == allowed.npos ? '_' : letter;
  }
  return data / "sensor-maps" / (name + ".png");
}

void keep_sensor_map(const std::filesystem::path& data, std::string_view serial,
                     const std::filesystem::path& folder) {
  if (serial.empty()) {
    return;
  }
  if (const std::optional<std::string> map =
          read_regular_file(sensor_map_of(data, serial), max_map_bytes)) {
    write_file(folder / sensor_map_file, *map);
  }
}

}  // namespace octurn
