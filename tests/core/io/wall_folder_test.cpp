#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "octurn/png.hpp"
#include "octurn/sensor_map.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

const json wall_json{{"format", "octurn-wall"},
                     {"version", 1},
                     {"sensor",
                      {{"name", "Kinect v1"},
                       {"serial", "A00361"},
                       {"width", 4},
                       {"height", 3},
                       {"fx", 5.5},
                       {"fy", 5.25},
                       {"cx", 2},
                       {"cy", 1.5},
                       {"depth_unit_m", 0.001}}},
                     {"frames", {"frames/000.png", "frames/001.png"}}};

/// The message with which a wall.json is refused that has one value changed.
std::string refusal(const std::string& pointer, const json& value) {
  json document = wall_json;
  document[json::json_pointer(pointer)] = value;
  const Error error = error_thrown_by([&] { parse_wall(document.dump()); });
  EXPECT_EQ(error.code(), ErrorCode::recording_malformed);
  return error.what();
}

TEST(WallFolder, IsReadAsOtherProgramsWriteIt) {
  const Wall wall = parse_wall(wall_json.dump());
  EXPECT_EQ(wall.sensor_name, "Kinect v1");
  EXPECT_EQ(wall.sensor_serial, "A00361");
  EXPECT_EQ(wall.intrinsics.width, 4);
  EXPECT_EQ(wall.intrinsics.fy, 5.25);
  EXPECT_EQ(wall.intrinsics.depth_unit, 0.001);
  EXPECT_EQ(wall.frames, (std::vector<std::string>{"frames/000.png", "frames/001.png"}));
}

TEST(WallFolder, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  write_wall(folder.path(), parse_wall(wall_json.dump()));
  EXPECT_EQ(json::parse(content_of(folder.path() / "wall.json")), wall_json);

  const DepthFrame frame{.width = 4, .height = 3, .depth = std::vector<std::uint16_t>(12, 700)};
  write_depth_png(folder.path() / wall_frame_file(1), frame);
  const Wall wall = read_wall(folder.path());
  EXPECT_EQ(read_wall_frame(folder.path(), wall, 1).depth, frame.depth);
  EXPECT_EQ(code_thrown_by([&] { read_wall_frame(folder.path(), wall, 0); }),
            "recording-malformed");
}

TEST(WallFolder, NamesWhatIsWrong) {
  EXPECT_NE(refusal("/format", "octurn-scan").find("\"format\""), std::string::npos);
  EXPECT_NE(refusal("/version", 2).find("\"version\""), std::string::npos);
  EXPECT_NE(refusal("/sensor/width", 0).find("\"sensor.width\""), std::string::npos);
  EXPECT_NE(refusal("/sensor/serial", 7).find("\"sensor.serial\""), std::string::npos);
  EXPECT_NE(refusal("/frames", json::array()).find("\"frames\""), std::string::npos);
  EXPECT_NE(refusal("/frames/1", "../secret.png").find("\"frames[1]\""), std::string::npos);
}

TEST(WallFolder, IsNoFolderWithoutItsFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(code_thrown_by([&] { read_wall(folder.path()); }), "recording-malformed");
}

}  // namespace
}  // namespace octurn
