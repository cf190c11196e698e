// octurn record --usb: what it writes of a Kinect's USB, and the emulated Kinect that repeats it.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "kinect/plain_frames.hpp"
#include "octurn/file.hpp"
#include "rig/usb_log.hpp"
#include "support/program.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// `octurn record` with these words and `--usb FILE`. @return its exit status
int record(const fs::path& file, std::vector<std::string> words, std::string& errors) {
  words.insert(words.begin(), {octurn_program(), "record", "--simulate", "--simulate-speed", "20",
                               "--usb", file.string()});
  Program program(words);
  const int status = program.wait();
  errors = program.errors();
  return status;
}

/// Records a Kinect, and expects that to succeed. @return the file's text
std::string recorded(const fs::path& file, std::vector<std::string> words) {
  words.insert(words.end(), {"--sensor", "kinect://"});
  std::string errors;
  EXPECT_EQ(record(file, std::move(words), errors), 0) << errors;
  return read_regular_file(file, max_usb_log_bytes).value_or("");
}

double share_of(const std::vector<bool>& lost) {
  return static_cast<double>(std::ranges::count(lost, true)) / static_cast<double>(lost.size());
}

TEST(KinectRecord, WritesPacketsTimesAndLosses) {
  const TemporaryFolder folder;
  KinectOnDesk desk({frame_of(700)});
  desk->loss_period = 3;
  desk->first_lost = 100;
  desk->lost_packets = 20;
  const std::string text = recorded(folder.path() / "usb", {"--usb-seconds", "1"});
  const std::vector<UsbPacket> packets = parse_usb_log(text);
  ASSERT_GT(packets.size(), 2000U);
  EXPECT_LE(packets.size(), 8000U);
  EXPECT_EQ(packets.front().time_us, 0);
  EXPECT_LE(packets.back().time_us, 2'000'000);
  // The readings are all alike, and their bytes would be in a file with pictures.
  EXPECT_EQ(std::ranges::max(packets, {}, &UsbPacket::bytes).bytes, 1760);
  EXPECT_NEAR(share_of(lost_packets(packets)), 20 / (3 * 242.0), 0.01);
  EXPECT_NE(text.find("# Kinect v1\n"), std::string::npos);
  EXPECT_EQ(text.find("A00000000000000A"), std::string::npos) << "its serial number";
}

TEST(KinectRecord, IsRepeatedByAnEmulatedKinect) {
  const TemporaryFolder folder;
  std::string text;
  {
    KinectOnDesk desk({frame_of(700)});
    desk->loss_period = 3;
    desk->first_lost = 100;
    desk->lost_packets = 20;
    text = recorded(folder.path() / "usb", {"--usb-seconds", "1"});
  }
  KinectOnDesk desk(plain_frames(3));
  desk.repeat_losses(text);
  const auto sensor = open_sensor("kinect://");
  int damaged = 0;
  for (int i = 0; i < 9; ++i) {
    const std::size_t lost = sensor->read({}).value().lost.size();
    EXPECT_TRUE(lost == 0 || (lost >= std::size_t{20} * 1271 && lost <= std::size_t{20} * 1273))
        << lost;
    damaged += lost > 0 ? 1 : 0;
  }
  EXPECT_EQ(damaged, 3);
}

TEST(KinectRecord, RecordsATurnToo) {
  const TemporaryFolder folder;
  const KinectOnDesk desk({frame_of(700)});
  const std::string text = recorded(
      folder.path() / "usb", {"-o", folder.path() / "turn", "--snapshots", "2", "--frames", "3"});
  EXPECT_GT(parse_usb_log(text).size(), 6U * 242);
  EXPECT_TRUE(fs::exists(folder.path() / "turn" / "recording.json"));
}

TEST(KinectRecord, RecordsASilentKinect) {
  const TemporaryFolder folder;
  KinectOnDesk desk({frame_of(700)});
  desk->silent = true;
  const std::string text = recorded(folder.path() / "usb", {"--usb-seconds", "3"});
  EXPECT_TRUE(std::ranges::all_of(parse_usb_log(text), [](const UsbPacket& packet) {
    return packet.bytes == 0;
  })) << text.substr(0, 1000);
}

TEST(KinectRecord, WritesNothingIfItIsUnplugged) {
  const TemporaryFolder folder;
  KinectOnDesk desk({frame_of(700)});
  desk.unplug();
  std::string errors;
  EXPECT_EQ(record(folder.path() / "usb", {"--sensor", "kinect://"}, errors), 1);
  EXPECT_NE(errors.find("none is plugged in"), std::string::npos) << errors;
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(KinectRecord, RefusesASensorThatIsNoKinect) {
  const TemporaryFolder folder;
  std::string errors;
  EXPECT_EQ(record(folder.path() / "usb", {}, errors), 1);
  EXPECT_NE(errors.find("packets of this sensor cannot be recorded"), std::string::npos) << errors;
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace octurn
