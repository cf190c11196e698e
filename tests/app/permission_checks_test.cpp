#include <gtest/gtest.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "doctor/machine_checks.hpp"
#include "support/temporary_folder.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using State = Finding::State;

constexpr uid_t nobody = 65534;

/// The files that describe a machine. Privileges of root are dropped, as root may open anything.
class Machine {
 public:
  Machine() {
    fs::permissions(folder_.path(), fs::perms::all);
    if (::geteuid() == 0) {
      EXPECT_EQ(::seteuid(nobody), 0);
      was_root_ = true;
    }
  }
  ~Machine() {
    if (was_root_) {
      EXPECT_EQ(::seteuid(0), 0);
    }
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  const fs::path& root() const { return folder_.path(); }

  /// Adds the kernel's description of a USB device.
  void has_usb(const std::string& name, const std::string& vendor,
               const std::string& product) const {
    const fs::path device = root() / "sys/bus/usb/devices" / name;
    put(device / "idVendor", vendor + "\n");
    put(device / "idProduct", product + "\n");
    put(device / "busnum", "1\n");
    put(device / "devnum", "12\n");
  }

  void has_node(const std::string& path, fs::perms permissions) const {
    put(root() / path, "");
    fs::permissions(root() / path, permissions);
  }

 private:
  TemporaryFolder folder_;
  bool was_root_ = false;
};

constexpr fs::perms open_to_us = fs::perms::owner_read | fs::perms::owner_write;
constexpr fs::perms closed = fs::perms::owner_read;

TEST(UsbCheck, FindsAKinectThatMayBeUsed) {
  const Machine machine;
  machine.has_usb("usb1", "1d6b", "0002");
  machine.has_usb("1-1.1", "045e", "02b0");
  machine.has_usb("1-1.3", "045e", "02ae");
  machine.has_node("dev/bus/usb/001/012", open_to_us);
  const Finding finding = check_usb(machine.root());
  EXPECT_EQ(finding.state, State::ok);
  EXPECT_EQ(finding.measured, "Kinect at /dev/bus/usb/001/012");
}

TEST(UsbCheck, FindsAKinectThatMayNotBeUsed) {
  const Machine machine;
  machine.has_usb("1-1.3", "045e", "02ae");
  machine.has_node("dev/bus/usb/001/012", closed);
  const Finding finding = check_usb(machine.root());
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_NE(finding.advice.find("udev"), std::string::npos);
}

TEST(UsbCheck, FindsAKinectWithoutItsPowerSupply) {
  const Machine machine;
  machine.has_usb("1-1.1", "045e", "02b0");
  const Finding finding = check_usb(machine.root());
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_NE(finding.advice.find("power supply"), std::string::npos);
}

TEST(UsbCheck, FindsThatNoSensorIsThere) {
  const Machine machine;
  EXPECT_EQ(check_usb(machine.root()).state, State::warning);
  machine.has_usb("1-1", "046d", "c077");  // a mouse
  EXPECT_EQ(check_usb(machine.root()).state, State::warning);
}

TEST(UsbCheck, KnowsEveryXtion) {
  const Machine machine;
  machine.has_usb("1-1", "1d27", "0601");
  machine.has_node("dev/bus/usb/001/012", open_to_us);
  EXPECT_EQ(check_usb(machine.root()).state, State::ok);
}

TEST(GpioPermissionCheck, NamesTheChipThatMayNotBeUsed) {
  const Machine machine;
  EXPECT_EQ(check_gpio_permission(machine.root()).state, State::unknown);
  machine.has_node("dev/gpiochip0", open_to_us);
  EXPECT_EQ(check_gpio_permission(machine.root()).state, State::ok);
  EXPECT_EQ(check_gpio_permission(machine.root()).measured, "1 chip may be used");
  machine.has_node("dev/gpiochip1", closed);
  const Finding finding = check_gpio_permission(machine.root());
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_NE(finding.measured.find("/dev/gpiochip1"), std::string::npos);
}

TEST(DataFolderCheck, WantsAFolderThatCanBeWrittenTo) {
  const Machine machine;
  EXPECT_EQ(check_data_folder(machine.root()).state, State::ok);
  const fs::path new_one = machine.root() / "var" / "octurn";
  EXPECT_EQ(check_data_folder(new_one).measured, new_one.string() + " will be made");
  fs::create_directories(new_one);
  fs::permissions(new_one, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(check_data_folder(new_one).state, State::fault);
  EXPECT_EQ(check_data_folder(new_one / "deeper").state, State::fault);
}

TEST(DataFolderCheck, RefusesAFile) {
  const Machine machine;
  machine.has_node("scans", fs::perms::all);
  EXPECT_EQ(check_data_folder(machine.root() / "scans").state, State::fault);
}

TEST(RealTimeCheck, WarnsWhereItIsRefused) {
  EXPECT_EQ(check_real_time("").state, State::ok);
  const Finding finding = check_real_time("Operation not permitted");
  EXPECT_EQ(finding.state, State::warning);
  EXPECT_EQ(finding.measured, "not allowed (Operation not permitted)");
}

/// The number after `key=` in a text; nothing if there is none.
std::optional<int> number_after(const std::string& key, const std::string& text) {
  const std::size_t at = text.find(key + "=");
  return at == text.npos ? std::nullopt
                         : std::optional(std::stoi(text.substr(at + key.size() + 1)));
}

// With a lower limit the kernel refuses real-time priority altogether.
TEST(RealTimeCheck, AdvisesThePriorityThatTheUnitAllowsAndTheProgramAsksFor) {
  EXPECT_EQ(number_after("LimitRTPRIO", content_of(OCTURN_UNIT)), real_time_priority);
  EXPECT_EQ(number_after("LimitRTPRIO", check_real_time("refused").advice), real_time_priority);
}

}  // namespace
}  // namespace octurn
