#include "commands/start_record.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto long_enough = 1min;
constexpr std::size_t max_bytes = 4096;

/// The kernel's id of this boot. Starts of earlier boots do not count: the machine may have lost
/// power, which is no crash of a driver.
std::string read_boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  file >> id;
  return id;
}

/// The number of starts of a boot that the file counts; 0 if it is of another boot.
int read_starts(const fs::path& file, const std::string& boot) {
  std::istringstream text(read_regular_file(file, max_bytes).value_or(""));
  std::string of_boot;
  int starts = 0;
  text >> of_boot >> starts;
  return text && of_boot == boot ? starts : 0;
}

}  // namespace

StartRecord::StartRecord(const fs::path& data) : file_(data / "starts") {
  try {
    const std::string boot = read_boot_id();
    failed_starts_ = read_starts(file_, boot);
    write_file(file_, boot + " " + std::to_string(failed_starts_ + 1) + "\n");
  } catch (const Error& error) {
    log::info("octurn", std::string("this start is not counted: ") + error.what());
  }
}

StartRecord::~StartRecord() { forget(); }

void StartRecord::remove_when_stable() {
  if (std::chrono::steady_clock::now() - began_ > long_enough) {
    forget();
  }
}

void StartRecord::forget() {
  if (is_kept_) {
    is_kept_ = false;
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
}

}  // namespace octurn
