#include "doctor/permission_checks.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "doctor/system_files.hpp"
#include "store/scan_store.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

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

}  // namespace octurn
