#include "doctor/machine_checks.hpp"

#include <gtest/gtest.h>

#include <string>

#include "support/temporary_folder.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

using State = Finding::State;

/// The files that identify a Raspberry Pi.
class Pi {
 public:
  const std::filesystem::path& root() const { return folder_.path(); }
  void has(const std::string& file, const std::string& content) const {
    put(folder_.path() / file, content + "\n");
  }
  void is_as_hot_as(const std::string& millicelsius) const {
    has("sys/class/thermal/thermal_zone0/type", "cpu-thermal");
    has("sys/class/thermal/thermal_zone0/temp", millicelsius);
  }
  void is_throttled(const std::string& bits) const {
    has("sys/devices/platform/soc/soc:firmware/get_throttled", bits);
  }
  void has_alarm(const std::string& alarm) const {
    has("sys/class/hwmon/hwmon0/name", "cpu_thermal");
    has("sys/class/hwmon/hwmon1/name", "rpi_volt");
    has("sys/class/hwmon/hwmon1/in0_lcrit_alarm", alarm);
  }
  void has_memory(const std::string& available_kb) const {
    has("proc/meminfo",
        "MemTotal:        3884104 kB\nMemFree:          123456 kB\nMemAvailable:    " +
            available_kb + " kB\nHugePages_Total:       0");
  }

 private:
  TemporaryFolder folder_;
};

constexpr ScanBytes scan{.largest = 150'000'000, .usual = 10'000'000};

TEST(DiskCheck, CountsTheScansThatCanBeStarted) {
  const Finding finding = check_disk(scan.largest + 39 * scan.usual, scan);
  EXPECT_EQ(finding.state, State::ok);
  EXPECT_EQ(finding.measured, "540 MB free, enough for 40 scans");
  EXPECT_EQ(finding.advice, "");
}

TEST(DiskCheck, WarnsBeforeItIsFull) {
  EXPECT_EQ(check_disk(scan.largest + 4 * scan.usual, scan).state, State::ok);
  EXPECT_EQ(check_disk(scan.largest + 4 * scan.usual - 1, scan).state, State::warning);
  EXPECT_EQ(check_disk(scan.largest, scan).measured, "150 MB free, enough for 1 scan");
  const Finding full = check_disk(scan.largest - 1, scan);
  EXPECT_EQ(full.state, State::fault);
  EXPECT_EQ(full.advice, "Delete scans that are no longer needed.");
  EXPECT_EQ(full.action, Action::choose_scans);
}

TEST(MemoryCheck, ComparesWhatIsThereWithWhatMayBeUsed) {
  const Pi pi;
  pi.has_memory("2097152");  // 2 GiB
  const Finding enough = check_memory(pi.root(), 1U << 30U);
  EXPECT_EQ(enough.state, State::ok);
  EXPECT_EQ(enough.measured, "2.1 GB available, 1.1 GB allowed for a model");
  const Finding few = check_memory(pi.root(), (std::size_t{2} << 30U) + 1);
  EXPECT_EQ(few.state, State::warning);
  EXPECT_NE(few.advice.find("memory_limit_mb"), std::string::npos);
}

TEST(MemoryCheck, FindsThatThereIsNext) {
  const Pi pi;
  pi.has_memory("65535");
  EXPECT_EQ(check_memory(pi.root(), 0).state, State::fault);
  pi.has_memory("65536");
  EXPECT_EQ(check_memory(pi.root(), 0).state, State::ok);
}

TEST(TemperatureCheck, WarnsBeforeTheProcessorSlowsDown) {
  const Pi pi;
  pi.is_as_hot_as("48312");
  EXPECT_EQ(check_temperature(pi.root()).state, State::ok);
  EXPECT_EQ(check_temperature(pi.root()).measured, "48.3 °C");
  pi.is_as_hot_as("70000");
  EXPECT_EQ(check_temperature(pi.root()).state, State::warning);
  pi.is_as_hot_as("80000");
  EXPECT_EQ(check_temperature(pi.root()).state, State::fault);
}

TEST(TemperatureCheck, PassesOverWhatIsNoProcessor) {
  const Pi pi;
  pi.has("sys/class/thermal/thermal_zone0/type", "acpitz");
  pi.has("sys/class/thermal/thermal_zone0/temp", "99000");
  EXPECT_EQ(check_temperature(pi.root()).state, State::unknown);
}

TEST(SupplyCheck, TellsUnderVoltageNowFromBefore) {
  const Pi pi;
  pi.is_throttled("0");
  EXPECT_EQ(check_supply(pi.root())->state, State::ok);
  pi.is_throttled("50000");
  EXPECT_EQ(check_supply(pi.root())->state, State::warning);
  pi.is_throttled("0x50005");
  EXPECT_EQ(check_supply(pi.root())->state, State::fault);
  EXPECT_NE(check_supply(pi.root())->advice, "");
}

TEST(SupplyCheck, HearsTheKernelsAlarm) {
  const Pi pi;
  pi.has_alarm("0");
  EXPECT_EQ(check_supply(pi.root())->state, State::ok);
  pi.has_alarm("1");
  EXPECT_EQ(check_supply(pi.root())->state, State::fault);
}

TEST(ThrottlingCheck, TellsSlowNowFromBefore) {
  const Pi pi;
  pi.is_throttled("10001");  // under-voltage only
  EXPECT_EQ(check_throttling(pi.root())->state, State::ok);
  pi.is_throttled("80000");
  EXPECT_EQ(check_throttling(pi.root())->measured, "it has been slowed down");
  for (const char* now : {"2", "4", "8"}) {
    pi.is_throttled(now);
    EXPECT_EQ(check_throttling(pi.root())->measured, "slowed down") << now;
    EXPECT_EQ(check_throttling(pi.root())->state, State::warning) << now;
  }
}

TEST(MachineChecks, KnowNothingOfAMachineThatTellsNothing) {
  const TemporaryFolder bare;
  for (const Finding& finding : {check_memory(bare.path(), 1), check_temperature(bare.path())}) {
    EXPECT_EQ(finding.state, State::unknown) << finding.name;
    EXPECT_EQ(finding.measured, "not known on this machine") << finding.name;
  }
  EXPECT_FALSE(check_supply(bare.path())) << "as on Debian's kernel";
  EXPECT_FALSE(check_throttling(bare.path()));
}

TEST(ClockCheck, WantsSomebodyWhoHasSetIt) {
  const Pi pi;
  const auto noon = std::chrono::system_clock::time_point(std::chrono::seconds(1'795'262'400));
  const Finding unset = check_clock(pi.root(), noon, false);
  EXPECT_EQ(unset.state, State::warning);
  EXPECT_EQ(unset.measured, "2026-11-21 12:00 UTC, not from a time server");
  EXPECT_EQ(check_clock(pi.root(), noon, true).state, State::ok);
  pi.has("run/systemd/timesync/synchronized", "");
  EXPECT_TRUE(is_clock_synchronised(pi.root()));
}

TEST(ClockCheck, TrustsAMachineWithAClockOfItsOwn) {
  const Pi pi;
  pi.has("sys/class/rtc/rtc0/name", "rtc_cmos");
  EXPECT_EQ(check_clock(pi.root(), {}, false).state, State::ok);
}

}  // namespace
}  // namespace octurn
