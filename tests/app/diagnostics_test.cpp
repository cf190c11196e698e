#include "doctor/diagnostics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "calibration/calibration_store.hpp"
#include "calibration/optics_files.hpp"
#include "store/job_file.hpp"
#include "support/temporary_folder.hpp"
#include "support/zip.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Job job_of(const std::string& id, const std::string& name) {
  return {.id = id,
          .label = {.name = name},
          .state = JobState::failed,
          .times = {.created = "2026-11-21T08:15:00Z"}};
}

std::vector<std::string> names_of(const std::vector<ArchivedFile>& files) {
  std::vector<std::string> names;
  for (const ArchivedFile& file : files) {
    names.push_back(file.name);
  }
  return names;
}

TEST(Diagnostics, HasTheMachinesFilesInOneOrder) {
  const TemporaryFolder root;
  EXPECT_EQ(
      names_of(machine_diagnostics({}, {}, root.path())),
      (std::vector<std::string>{"versions.json", "settings.json", "doctor.json", "system.txt"}));
}

TEST(Diagnostics, TellsVersions) {
  const json versions = json_in(machine_diagnostics({}, {}), "versions.json");
  EXPECT_EQ(versions["octurn"], version());
  EXPECT_TRUE(versions["openni2"].get<std::string>().starts_with("2.")) << versions;
  EXPECT_GE(versions["libgpiod"].get<std::string>().size(), 3U) << versions;
  EXPECT_TRUE(versions["kernel"].get<std::string>().starts_with("Linux ")) << versions;
  EXPECT_NE(versions["libraries"].dump().find("/libOpenNI2.so."), std::string::npos) << versions;
}

// The file is valid as Octurn's own configuration.
TEST(Diagnostics, TellsSettingsAsTheirFileHasThem) {
  Config config;
  config.http.port = 8123;
  config.turntable.gear_ratio = 4;
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", content_in(machine_diagnostics(config, {}), "settings.json"));
  const Config again = read_config(folder.path() / "octurn.json");
  EXPECT_EQ(again.http.port, 8123);
  EXPECT_EQ(again.turntable.gear_ratio, 4);
}

TEST(Diagnostics, TellsWhatTheDoctorFound) {
  const std::vector<Finding> findings{
      {.check = "disk", .state = Finding::State::fault, .measured = "nothing free"}};
  const json report = json_in(machine_diagnostics({}, findings), "doctor.json");
  EXPECT_EQ(report["state"], "fault");
  EXPECT_EQ(report["findings"][0]["measured"], "nothing free");
}

TEST(Diagnostics, ShowsTheSystemsFilesAsTheyAre) {
  const TemporaryFolder root;
  put(root.path() / "etc/os-release", "ID=debian\n");
  put(root.path() / "proc/device-tree/model", std::string_view("Raspberry Pi 4\0", 15));
  put(root.path() / "sys/devices/platform/soc/soc:firmware/get_throttled", "50005\n");
  put(root.path() / "sys/class/thermal/thermal_zone0/temp", "61234\n");
  put(root.path() / "sys/bus/usb/devices/1-1.2/idProduct", "02ae\n");
  EXPECT_EQ(content_in(machine_diagnostics({}, {}, root.path()), "system.txt"),
            "==> /etc/os-release <==\nID=debian\n\n"
            "==> /proc/device-tree/model <==\nRaspberry Pi 4\n\n"
            "==> /sys/devices/platform/soc/soc:firmware/get_throttled <==\n50005\n\n"
            "==> /sys/class/thermal/thermal_zone0/temp <==\n61234\n\n"
            "==> /sys/bus/usb/devices/1-1.2/idProduct <==\n02ae\n\n");
}

TEST(Diagnostics, LeavesOutWhatTellsOneMachineFromOthers) {
  const TemporaryFolder root;
  for (const char* const file :
       {"etc/hostname", "etc/machine-id", "proc/cpuinfo", "proc/cmdline", "proc/self/environ",
        "proc/device-tree/serial-number", "sys/bus/usb/devices/1-1/serial"}) {
    put(root.path() / file, "private\n");
  }
  const std::vector<ArchivedFile> files = machine_diagnostics({}, {}, root.path());
  ASSERT_FALSE(files.empty());
  for (const ArchivedFile& file : files) {
    EXPECT_EQ(file.content.find("private"), std::string::npos) << file.name;
  }
}

TEST(Diagnostics, TellsDevicesScansAndLogOfADaemon) {
  const Status status{.sensor = {.state = DeviceStatus::State::failed,
                                 .name = "Kinect v1",
                                 .failure = {.detail = "no frame for 2 s"}}};
  Job failed = job_of("20261121-081500-3f2a", "");
  failed.failure = Failure{.code = ErrorCode::sensor_silent, .detail = "no frame for 2 s"};
  const std::vector<Job> scans{failed};
  const std::vector<ArchivedFile> files = daemon_diagnostics(status, scans, "said\n");
  EXPECT_EQ(names_of(files), (std::vector<std::string>{"devices.json", "scans.json", "log.txt"}));
  EXPECT_EQ(json_in(files, "devices.json")["sensor"]["message"], "no frame for 2 s");
  const json scan = json_in(files, "scans.json")["scans"][0];
  EXPECT_EQ(scan["id"], failed.id);
  EXPECT_EQ(scan["state"], "failed");
  EXPECT_EQ(scan["error"]["code"], "sensor-silent");
  EXPECT_EQ(scan["settings"]["snapshots"], 36);
  EXPECT_EQ(content_in(files, "log.txt"), "said\n");
}

TEST(Diagnostics, TellsPosesAndOpticsWithoutSerialNumbers) {
  const TemporaryFolder folder;
  Config config;
  config.data = folder.path();
  CalibrationStore(config.data)
      .set({.origin = PoseOrigin::scan,
            .at = "2026-11-21T08:15:00Z",
            .optics_of = "A00362611",
            .optics_at = "2026-11-22T08:15:00Z"});
  keep_optics(config.data, "A00362611", {.at = "2026-11-22T08:15:00Z"});
  put(folder.path() / "optics/A00000000.json", "damaged");
  const std::vector<ArchivedFile> files{calibration_diagnostics(config)};
  const json calibration = json_in(files, "calibration.json");
  EXPECT_EQ(calibration["poses"][0]["at"], "2026-11-21T08:15:00Z") << calibration;
  EXPECT_TRUE(calibration["optics"][0].is_null()) << calibration;
  EXPECT_EQ(calibration["optics"][1][0]["at"], "2026-11-22T08:15:00Z") << calibration;
  EXPECT_EQ(files[0].content.find("A00"), std::string::npos) << files[0].content;
}

TEST(Diagnostics, TellsTheScansOfAFolderNewestFirst) {
  const TemporaryFolder folder;
  for (const char* const id : {"20261121-081500-3f2a", "20261122-081500-3f2a"}) {
    put(folder.path() / "scans" / id / "job.json", to_job_text(job_of(id, "private")));
  }
  put(folder.path() / "scans/20261123-081500-3f2a/job.json", "damaged");
  const std::vector<ArchivedFile> files{scan_diagnostics(folder.path())};
  const json scans = json_in(files, "scans.json")["scans"];
  ASSERT_EQ(scans.size(), 2U) << scans;
  EXPECT_EQ(scans[0]["id"], "20261122-081500-3f2a");
  EXPECT_EQ(files[0].content.find("private"), std::string::npos);
}

TEST(Diagnostics, LeavesOutWhatAPersonCalledAScan) {
  const std::vector<Job> scans{job_of("20261121-081500-3f2a", "private")};
  const std::vector<ArchivedFile> files = daemon_diagnostics({}, scans, "");
  EXPECT_TRUE(std::ranges::any_of(files, [](const ArchivedFile& file) {
    return file.content.find("20261121-081500-3f2a") != std::string::npos;  // the scan is listed
  }));
  for (const ArchivedFile& file : files) {
    EXPECT_EQ(file.content.find("private"), std::string::npos) << file.name;
  }
}

TEST(Diagnostics, IsBoundedHoweverMuchThereIs) {
  const TemporaryFolder root;
  for (const char* const file : {"etc/os-release", "proc/modules", "proc/meminfo"}) {
    put(root.path() / file, std::string(1U << 20U, 'x'));
  }
  std::vector<Job> scans(5000, job_of("20261121-081500-3f2a", ""));
  scans.front().id = "20261121-090000-0000";
  std::vector<ArchivedFile> files = machine_diagnostics({}, {}, root.path());
  for (ArchivedFile& file : daemon_diagnostics({}, scans, "")) {
    files.push_back(std::move(file));
  }
  std::size_t bytes = 0;
  for (const ArchivedFile& file : files) {
    bytes += file.content.size();
  }
  EXPECT_LT(bytes, 3U << 20U);  // which leaves room for a log of 1 MiB
  const json stored = json_in(files, "scans.json");
  EXPECT_EQ(stored["scans"][0]["id"], "20261121-090000-0000");
  EXPECT_GT(stored["scans"].size(), 500U);
  EXPECT_EQ(stored["scans"].size() + stored["left_out"].get<std::size_t>(), scans.size());
}

}  // namespace
}  // namespace octurn
