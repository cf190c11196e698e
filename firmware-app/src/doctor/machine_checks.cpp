#include "doctor/machine_checks.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <exception>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/units.hpp"
#include "rig/interruptible_sleep.hpp"
#include "store/scan_store.hpp"
#include "turntable/real_time.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr Check settings_check{"settings", "Settings"};
constexpr Check disk{"disk", "Disk space"};
constexpr Check memory{"memory", "Memory"};
constexpr Check temperature{"temperature", "CPU temperature"};
constexpr Check supply{"supply", "Supply voltage"};
constexpr Check throttling{"throttling", "CPU speed"};
constexpr Check clock_set{"clock", "Clock"};

constexpr const char* not_known = "not known on this machine";

constexpr std::uint64_t few_scans = 5;

// A model with a leaf size of 1 mm takes less. Below this the kernel itself runs short.
constexpr double min_memory = bytes_from_mb(64);

// A Raspberry Pi lowers its clock at 80 degrees; some models lower it a little at 60.
constexpr double warm = 70;
constexpr double hot = 80;

/// `get_throttled` of a Raspberry Pi's firmware: flags of the present, and the same flags 16 bits
/// higher for any time since it started (Raspberry Pi documentation, vcgencmd).
struct Throttled {
  unsigned bits = 0;

  static constexpr unsigned under_voltage = 1U << 0U;
  static constexpr unsigned slowed = (1U << 1U) | (1U << 2U) | (1U << 3U);

  bool now(unsigned what) const { return (bits & what) != 0; }
  bool before(unsigned what) const { return ((bits >> 16U) & what) != 0; }
};

std::optional<Throttled> throttled(const fs::path& root) {
  const auto text = first_line(root / "sys/devices/platform/soc/soc:firmware/get_throttled");
  if (!text) {
    return std::nullopt;
  }
  const std::string_view digits = std::string_view(*text).substr(text->starts_with("0x") ? 2 : 0);
  Throttled flags;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), flags.bits, 16);
  return end.ec == std::errc() ? std::optional(flags) : std::nullopt;
}

/// The under-voltage alarm of the kernel's driver raspberrypi-hwmon; nothing without that driver.
std::optional<bool> voltage_alarm(const fs::path& root) {
  for (const fs::path& device : entries(root / "sys/class/hwmon")) {
    if (first_line(device / "name") == "rpi_volt") {
      const auto alarm = first_line(device / "in0_lcrit_alarm");
      return alarm ? std::optional(*alarm != "0") : std::nullopt;
    }
  }
  return std::nullopt;
}

/// One value of /proc/meminfo, bytes.
std::optional<double> meminfo(const fs::path& root, const std::string& key) {
  std::ifstream lines(root / "proc/meminfo");
  for (std::string name; lines >> name;) {
    double kb = 0;
    lines >> kb;
    if (lines && name == key + ":") {
      return bytes_from_kb(kb);
    }
    lines.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::nullopt;
}

}  // namespace

Finding check_settings(const std::string& trouble) {
  return trouble.empty()
             ? settings_check.ok("as they were stored")
             : settings_check.warning(trouble + "; the last ones that can be used are in force",
                                      "Look through the page's settings and save them again.",
                                      Action::open_settings);
}

Finding check_disk(std::uint64_t free, const ScanBytes& scan) {
  constexpr const char* advice = "Delete scans that are no longer needed.";
  const std::uint64_t scans = free < scan.largest ? 0 : 1 + (free - scan.largest) / scan.usual;
  const std::string measured = readable_bytes(static_cast<double>(free)) + " free, enough for " +
                               std::to_string(scans) + (scans == 1 ? " scan" : " scans");
  return scans == 0          ? disk.fault(measured, advice, Action::choose_scans)
         : scans < few_scans ? disk.warning(measured, advice, Action::choose_scans)
                             : disk.ok(measured);
}

Finding check_memory(const fs::path& root, std::size_t limit) {
  const std::optional<double> available = meminfo(root, "MemAvailable");
  if (!available) {
    return memory.unknown(not_known);
  }
  const auto wanted = static_cast<double>(limit);
  const std::string measured =
      readable_bytes(*available) + " available" +
      (limit == 0 ? "" : ", " + readable_bytes(wanted) + " allowed for a model");
  if (*available < min_memory) {
    return memory.fault(measured, "End other programs on this machine, or start it again.");
  }
  return *available < wanted
             ? memory.warning(measured,
                              "End other programs, or lower memory_limit_mb in octurn.json.")
             : memory.ok(measured);
}

Finding check_temperature(const fs::path& root) {
  std::optional<double> hottest;
  for (const fs::path& zone : entries(root / "sys/class/thermal")) {
    const std::string type = first_line(zone / "type").value_or("");
    const std::optional<double> reading = number_in(zone / "temp");
    if (reading && (type.find("cpu") != type.npos || type == "x86_pkg_temp")) {
      hottest = std::max(hottest.value_or(-273), celsius_from_millicelsius(*reading));
    }
  }
  if (!hottest) {
    return temperature.unknown(not_known);
  }
  const std::string measured = rounded(*hottest, 1) + " °C";
  if (*hottest >= hot) {
    return temperature.fault(measured,
                             "Cool the computer: give it a heat sink, a fan or a place with air.");
  }
  return *hottest >= warm
             ? temperature.warning(measured, "See that air can reach the computer's processor.")
             : temperature.ok(measured);
}

std::optional<Finding> check_supply(const fs::path& root) {
  constexpr const char* advice =
      "Use the power supply made for this Raspberry Pi, with a short, thick cable.";
  const std::optional<Throttled> flags = throttled(root);
  const std::optional<bool> alarm = voltage_alarm(root);
  if (!flags && !alarm) {
    return std::nullopt;
  }
  if (alarm.value_or(false) || (flags && flags->now(Throttled::under_voltage))) {
    return supply.fault("below 4.63 V", advice);
  }
  return flags && flags->before(Throttled::under_voltage)
             ? supply.warning("it has been below 4.63 V", advice)
             : supply.ok("above 4.63 V");
}

std::optional<Finding> check_throttling(const fs::path& root) {
  constexpr const char* advice = "Give the computer a stronger supply and better cooling.";
  const std::optional<Throttled> flags = throttled(root);
  if (!flags) {
    return std::nullopt;
  }
  return flags->now(Throttled::slowed)      ? throttling.warning("slowed down", advice)
         : flags->before(Throttled::slowed) ? throttling.warning("it has been slowed down", advice)
                                            : throttling.ok("full");
}

Finding check_clock(const fs::path& root, std::chrono::system_clock::time_point now,
                    bool synchronised) {
  const std::string time = utc_text(now, "%Y-%m-%d %H:%M UTC");
  if (synchronised) {
    return clock_set.ok(time + ", from a time server");
  }
  return entries(root / "sys/class/rtc").empty()
             ? clock_set.warning(
                   time + ", not from a time server",
                   "Connect the scanner to a network with internet, or its scans have wrong dates.")
             : clock_set.ok(time + ", from this machine's own clock");
}

namespace {

constexpr Check usb{"usb", "USB"};
constexpr Check gpio_permission{"gpio-permission", "GPIO permission"};
constexpr Check data_folder{"data-folder", "Folder of the scans"};
constexpr Check real_time{"real-time", "Real-time priority"};

/// A USB device that is a supported sensor or part of one.
struct UsbKind {
  std::string_view vendor;
  std::string_view product;  // empty: every product of the vendor
  std::string_view name;
  bool is_camera;
};

// Without its own power supply a Kinect shows its hub and motor, but no camera: USB powers only
// those.
constexpr std::array usb_kinds{
    UsbKind{"045e", "02ae", "Kinect", true},
    UsbKind{"045e", "02bf", "Kinect for Windows", true},
    UsbKind{"1d27", "", "PrimeSense sensor", true},
    UsbKind{"045e", "02b0", "Kinect's motor", false},
    UsbKind{"045e", "02ad", "Kinect's microphones", false},
    UsbKind{"045e", "02be", "Kinect's microphones", false},
    UsbKind{"045e", "02c2", "Kinect's hub", false},
};

const UsbKind* find_usb_kind(const fs::path& device) {
  const std::string vendor = first_line(device / "idVendor").value_or("");
  const std::string product = first_line(device / "idProduct").value_or("");
  const auto* kind = std::ranges::find_if(usb_kinds, [&](const UsbKind& known) {
    return known.vendor == vendor && (known.product.empty() || known.product == product);
  });
  return kind == usb_kinds.end() ? nullptr : kind;
}

std::string three_digits(const fs::path& file) {
  const std::string number = first_line(file).value_or("");
  return std::string(number.size() < 3 ? 3 - number.size() : 0, '0') + number;
}

/// The device file that libusb opens, such as dev/bus/usb/001/005.
fs::path usb_node(const fs::path& device) {
  return fs::path("dev/bus/usb") / three_digits(device / "busnum") /
         three_digits(device / "devnum");
}

}  // namespace

Finding check_usb(const fs::path& root) {
  bool is_without_camera = false;
  for (const fs::path& device : entries(root / "sys/bus/usb/devices")) {
    const UsbKind* kind = find_usb_kind(device);
    if (kind == nullptr) {
      continue;
    }
    if (!kind->is_camera) {
      is_without_camera = true;
      continue;
    }
    const fs::path node = usb_node(device);
    const std::string measured = std::string(kind->name) + " at /" + node.string();
    return may_use(root / node)
               ? usb.ok(measured)
               : usb.fault(measured + ", which this user may not use",
                           "Install libopenni2-0, whose udev rules open it, and plug it in again.");
  }
  if (is_without_camera) {
    return usb.fault("a Kinect's motor or hub, but not its camera",
                     "Connect the Kinect's own power supply: USB alone does not power its camera.");
  }
  return usb.warning("no Kinect, Xtion or other PrimeSense sensor",
                     "Plug the sensor into a USB port of this machine.");
}

Finding check_gpio_permission(const fs::path& root) {
  int chips = 0;
  for (const fs::path& device : entries(root / "dev")) {
    if (!device.filename().string().starts_with("gpiochip")) {
      continue;
    }
    ++chips;
    if (!may_use(device)) {
      return gpio_permission.fault(
          "/dev/" + device.filename().string() + ": this user may not use it",
          "Let this user use GPIO: sudo adduser $USER gpio, and log in again.");
    }
  }
  return chips == 0 ? gpio_permission.unknown("there is no GPIO chip to use")
                    : gpio_permission.ok(std::to_string(chips) + (chips == 1 ? " chip" : " chips") +
                                         " may be used");
}

Finding check_data_folder(const fs::path& data) {
  const fs::path there = existing_part(data);
  const bool may_write = ::faccessat(AT_FDCWD, there.c_str(), W_OK | X_OK, AT_EACCESS) == 0;
  if (!may_write || !fs::is_directory(there)) {
    return data_folder.fault(
        data.string() + " cannot be written to",
        "Let this user write there, or choose another folder with data in octurn.json.");
  }
  return data_folder.ok(data.string() + (there == data ? "" : " will be made"));
}

Finding check_real_time(const std::string& refusal) {
  return refusal.empty()
             ? real_time.ok("allowed")
             : real_time.warning("not allowed (" + refusal + ")",
                                 "Allow it with LimitRTPRIO=" + std::to_string(real_time_priority) +
                                     " in the service, or rtprio in limits.conf: else a busy "
                                     "machine turns the platform slowly.");
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;  // no such folder has no entries
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

std::optional<std::string> first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  return std::getline(stream, line) ? std::optional(line) : std::nullopt;
}

std::optional<double> number_in(const fs::path& file) {
  std::ifstream stream(file);
  double number = 0;
  return stream >> number ? std::optional(number) : std::nullopt;
}

bool may_use(const fs::path& file) {
  return ::faccessat(AT_FDCWD, file.c_str(), R_OK | W_OK, AT_EACCESS) == 0;
}

MachineWatch::MachineWatch(Sources sources, const WatchIntervals& intervals)
    : sources_(std::move(sources)), intervals_(intervals) {
  poll(std::chrono::steady_clock::now());
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void MachineWatch::poll(Time now) {
  MachineHealth health = *health_.get();
  std::string trouble;
  try {
    health.disk_free_bytes = sources_.free_bytes();
    if (!warnings_polled_ || now - *warnings_polled_ >= intervals_.warnings) {
      warnings_polled_ = now;
      health.warnings = sources_.warnings();
    }
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  if (!trouble.empty() && trouble != trouble_) {
    log::warning("machine", trouble);
  }
  trouble_ = std::move(trouble);
  if (health != *health_.get()) {
    health_.set(std::move(health));
  }
}

void MachineWatch::run(const std::stop_token& stop) {
  while (sleep_for(stop, intervals_.disk)) {
    poll(std::chrono::steady_clock::now());
  }
}

}  // namespace octurn
