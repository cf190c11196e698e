// octurn doctor's findings with an emulated Kinect.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "kinect/kinect_on_desk.hpp"
#include "rig/usb_log.hpp"
#include "support/program.hpp"
#include "support/zip.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A wall at 0.8 m.
Readings wall() { return Readings(std::size_t{640} * 480, 657); }

/// The doctor's finding of one check.
json finding(const char* check) {
  const TemporaryFolder folder;
  Program doctor({octurn_program(), "doctor", "--simulate", "--sensor", "kinect://", "--json",
                  "--data", folder.path()});
  doctor.wait();
  const json report = json::parse(doctor.output(), nullptr, false);
  for (const json& one : report["findings"]) {
    if (one["check"] == check) {
      return one;
    }
  }
  ADD_FAILURE() << doctor.output() << doctor.errors();
  return {};
}

TEST(KinectDoctor, ComparesTheTiltWithTheCalibration) {
  KinectOnDesk desk({wall()});
  desk->acceleration[2] = -819;  // pitched down by 45 degrees: as large as the upward component
  const json tilt = finding("tilt");
  EXPECT_EQ(tilt["measured"], "pitch -45.0°, roll 0.0°; calibrated at -25.0°, 0.0°");
  EXPECT_EQ(tilt["state"], "fault");
}

TEST(KinectDoctor, CountsLostFrames) {
  KinectOnDesk desk({wall()});
  desk->loss_period = 3;
  desk->first_lost = 100;
  desk->lost_packets = 60;
  const json lost = finding("lost-frames");
  EXPECT_EQ(lost["state"], "warning") << lost;
  EXPECT_NE(lost["measured"].get<std::string>().find(" whole, 0 in part, "), std::string::npos)
      << lost;  // 60 of 3 x 242 packets
  EXPECT_NE(lost["advice"].get<std::string>().find("USB port"), std::string::npos) << lost;
}

TEST(KinectDoctor, PutsARecordingOfTheWireIntoTheArchive) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "day.zip";
  KinectOnDesk desk({wall()});
  desk->loss_period = 2;
  desk->lost_packets = 12;
  Program doctor({octurn_program(), "doctor", "--simulate", "--sensor", "kinect://", "--data",
                  folder.path(), "--zip", file});
  doctor.wait();
  const std::vector<ArchivedFile> files = unzipped(content_of(file));
  const std::vector<UsbPacket> packets = parse_usb_log(content_in(files, "wire.txt"));
  EXPECT_GT(packets.size(), 10U * 242) << doctor.errors();
  EXPECT_GT(std::ranges::count(lost_packets(packets), true), 12);
  for (const ArchivedFile& one : files) {
    EXPECT_EQ(one.content.find("A00000000000000A"), std::string::npos) << one.name;
  }
}

TEST(KinectDoctor, CountsLostPackets) {
  KinectOnDesk desk({wall()});
  desk->lost_packets = 12;  // of each frame's 242
  const json lost = finding("lost-frames");
  EXPECT_EQ(lost["state"], "warning") << lost;
  EXPECT_NE(lost["measured"].get<std::string>().find(" lost; 5.0 % of"), std::string::npos) << lost;
}

TEST(KinectDoctor, CountsNoneOfAKinectThatIsWell) {
  const KinectOnDesk desk({wall()});
  EXPECT_NE(finding("lost-frames")["measured"].get<std::string>().find(
                " lost; 0.0 % of the packets lost"),
            std::string::npos);
}

TEST(KinectDoctor, FindsASilentKinect) {
  KinectOnDesk desk({wall()});
  desk->silent = true;
  const json sensor = finding("sensor");
  EXPECT_EQ(sensor["state"], "fault");
  EXPECT_EQ(sensor["measured"], "sensor: no frame for 2000 ms");
}

}  // namespace
}  // namespace octurn
