#include "kinect/usb_place.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>
#include <tuple>
#include <vector>

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Reads the first word of a sysfs attribute.
std::string word_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string word;
  stream >> word;
  return word;
}

int number_in(const fs::path& file) {
  std::ifstream stream(file);
  int number = 0;
  stream >> number;
  return number;
}

bool is_camera(const fs::path& device) {
  const std::string product = word_in(device / "idProduct");
  return word_in(device / "idVendor") == "045e" && (product == "02ae" || product == "02bf");
}

}  // namespace

std::string usb_place(int index, const fs::path& devices) {
  std::vector<std::tuple<int, int, std::string>> cameras;
  std::error_code error;
  for (fs::directory_iterator entry(devices, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (is_camera(entry->path())) {
      cameras.emplace_back(number_in(entry->path() / "busnum"), number_in(entry->path() / "devnum"),
                           entry->path().filename().string());
    }
  }
  std::ranges::sort(cameras);
  const auto at = static_cast<std::size_t>(index);
  return at < cameras.size() ? "usb-" + std::get<2>(cameras[at]) : std::string();
}

}  // namespace octurn
