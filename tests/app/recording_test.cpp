#include "sensor/recording.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "octurn/units.hpp"
#include "sensor/depth_sensor.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr Intrinsics small = {.width = 4, .height = 3, .fx = 5.5, .fy = 5.25, .cx = 2, .cy = 1.5};

DepthFrame frame_with(std::uint16_t depth) {
  return {.width = 4, .height = 3, .depth = std::vector<std::uint16_t>(12, depth)};
}

/// Writes a recording of two frames at each of two angles: depths 1000, 1001 and 2000, 2001.
fs::path write_recording(const fs::path& folder) {
  RecordingWriter writer(folder, "Kinect v1", "A1", small);
  for (const int stop : {0, 1}) {
    for (const int frame : {0, 1}) {
      writer.write(
          frame_with(static_cast<std::uint16_t>(1000 * (stop + 1) + frame)),
          {.time = std::chrono::duration<double>(2 * stop + frame / 30.0),
           .angle = radians_from_degrees(180 * stop),
           .tilt = stop == 0 ? std::optional(Tilt{.pitch = -0.4, .roll = 0.01}) : std::nullopt});
    }
  }
  writer.commit();
  return folder;
}

TEST(Recording, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  const fs::path file = write_recording(folder.path() / "turn");
  const Recording recording = read_recording(file);

  EXPECT_EQ(recording.sensor_name, "Kinect v1");
  EXPECT_EQ(recording.sensor_serial, "A1");
  EXPECT_EQ(recording.intrinsics.width, 4);
  EXPECT_EQ(recording.intrinsics.height, 3);
  EXPECT_EQ(recording.intrinsics.fx, 5.5);
  EXPECT_EQ(recording.intrinsics.fy, 5.25);
  EXPECT_EQ(recording.intrinsics.cx, 2);
  EXPECT_EQ(recording.intrinsics.cy, 1.5);
  EXPECT_EQ(recording.intrinsics.depth_unit, 0.0001);
  ASSERT_EQ(recording.frames.size(), 4);
  EXPECT_EQ(recording.frames[3].time.count(), 2 + 1 / 30.0);
  EXPECT_NEAR(recording.frames[3].angle, radians_from_degrees(180), 1e-15);
  EXPECT_NEAR(recording.frames[1].tilt->pitch, -0.4, 1e-15);
  EXPECT_NEAR(recording.frames[1].tilt->roll, 0.01, 1e-15);
  EXPECT_FALSE(recording.frames[2].tilt.has_value());
  EXPECT_EQ(read_recorded_frame(file, recording, 3).depth, frame_with(2001).depth);
}

TEST(Recording, IsThereWholeOrNotAtAll) {
  const TemporaryFolder folder;
  {
    RecordingWriter writer(folder.path() / "turn", "Kinect v1", "A1", small);
    writer.write(frame_with(7), {});
    EXPECT_FALSE(fs::exists(folder.path() / "turn"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Recording, ReplacesNothing) {
  const TemporaryFolder folder;
  put(folder.path() / "turn", "somebody's");
  EXPECT_EQ(
      code_thrown_by([&] { RecordingWriter(folder.path() / "turn", "Kinect v1", "A1", small); }),
      "write-failed");
  EXPECT_EQ(content_of(folder.path() / "turn"), "somebody's");
}

std::string text_of_recording() {
  const TemporaryFolder folder;
  return content_of(write_recording(folder.path() / "turn") / "recording.json");
}

TEST(Recording, RefusesEveryPartOfIt) {
  const std::string text = text_of_recording();
  const std::size_t end = text.rfind('}');
  for (std::size_t size = 0; size <= end; ++size) {
    ASSERT_EQ(code_thrown_by([&] { parse_recording(text.substr(0, size)); }), "recording-malformed")
        << size;
  }
}

TEST(Recording, NamesWhatIsWrong) {
  struct Fault {
    std::string from;
    std::string to;
    std::string named;
  };
  const std::string text = text_of_recording();
  for (const Fault& fault :
       {Fault{R"("format": "octurn-recording")", R"("format": "x")", "recording"},
        Fault{R"("version": 1)", R"("version": 2)", "version"},
        Fault{R"("width": 4)", R"("width": 0)", "width"},
        Fault{R"("fx": 5.5)", R"("fx": -5.5)", "fx"}, Fault{R"("fx": 5.5)", R"("fx": 1e300)", "fx"},
        Fault{R"("cx": 2.0)", R"("cx": -1e300)", "cx"},
        Fault{R"("depth_unit_m")", R"("depth_unit")", "depth_unit_m"},
        Fault{R"("time_s": 0.0)", R"("time_s": "0")", "time_s"},
        Fault{R"("angle_deg": 0.0)", R"("angle": 0.0)", "angle_deg"},
        Fault{R"("name")", R"("title")", "name"}}) {
    std::string wrong = text;
    const std::size_t at = wrong.find(fault.from);
    ASSERT_NE(at, std::string::npos) << fault.from;
    wrong.replace(at, fault.from.size(), fault.to);
    const Error error = error_thrown_by([&] { parse_recording(wrong); });
    EXPECT_EQ(error.code(), ErrorCode::recording_malformed);
    EXPECT_NE(std::string(error.what()).find(fault.named), std::string::npos) << error.what();
  }
}

std::uint16_t next_depth(DepthSensor& sensor) { return sensor.read({}).value().frame.depth[0]; }

TEST(RecordedSensor, GivesTheFramesOfTheAngleInTheirOrder) {
  const TemporaryFolder folder;
  const auto sensor = open_sensor(write_recording(folder.path() / "turn").string());
  EXPECT_EQ(sensor->name(), "Kinect v1 (recorded)");
  EXPECT_EQ(sensor->intrinsics().fx, 5.5);

  sensor->show_angle(radians_from_degrees(180 - 360));  // equivalent to 180
  EXPECT_EQ(next_depth(*sensor), 2000);
  EXPECT_EQ(next_depth(*sensor), 2001);
  EXPECT_EQ(next_depth(*sensor), 2000);
  EXPECT_FALSE(sensor->tilt().has_value());
  sensor->show_angle(0);
  EXPECT_EQ(next_depth(*sensor), 1000);
  sensor->show_angle(0);  // starts over
  EXPECT_EQ(next_depth(*sensor), 1000);
  EXPECT_EQ(next_depth(*sensor), 1001);
  EXPECT_NEAR(sensor->tilt()->pitch, -0.4, 1e-15);
}

TEST(RecordedSensor, SaysWhichAngleItHasNot) {
  const TemporaryFolder folder;
  const auto sensor = open_sensor(write_recording(folder.path() / "turn").string());
  sensor->show_angle(radians_from_degrees(90));
  const Error error = error_thrown_by([&] { sensor->read({}); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
  EXPECT_EQ(std::string(error.what()), "the recording has no frame at 90 degrees") << "and no path";
}

TEST(RecordedSensor, RefusesAFolderThatIsNoRecording) {
  const TemporaryFolder folder;
  const Error error = error_thrown_by([&] { open_sensor(folder.path().string()); });
  EXPECT_EQ(error.code(), ErrorCode::recording_malformed);
  EXPECT_FALSE(error.hint().empty());
}

TEST(RecordedSensor, RefusesARecordingThatCannotBeRead) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "folder" / "recording.json");
  fs::create_directories(folder.path() / "fifo");
  ASSERT_EQ(::mkfifo((folder.path() / "fifo" / "recording.json").c_str(), 0600), 0);
  for (const char* recording : {"folder", "fifo"}) {
    EXPECT_EQ(code_thrown_by([&] { open_sensor((folder.path() / recording).string()); }),
              "recording-malformed")
        << recording;
  }
}

TEST(RecordedSensor, RefusesADamagedFrame) {
  const TemporaryFolder folder;
  const fs::path recording = write_recording(folder.path() / "turn");
  put(recording / "frames" / "000000.png", "no picture");
  const auto sensor = open_sensor(recording.string());
  EXPECT_EQ(code_thrown_by([&] { sensor->read({}); }), "snapshot-malformed");
}

}  // namespace
}  // namespace octurn
