// `octurn calibrate --board` and `--print-board`, end to end.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/lens/board_picture.hpp"
#include "octurn/png.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class CalibrateBoardCommand : public ::testing::Test {
 protected:
  /// Runs a command; fails unless it ends with that status. @return what it printed
  static std::string run(int status, std::vector<std::string> words) {
    words.insert(words.begin(), octurn_program());
    Program program(words);
    EXPECT_EQ(program.wait(), status) << program.output() << program.errors();
    return status == 0 ? program.output() : program.output() + program.errors();
  }

  /// Draws pictures of a hand-held board. @param count  at most 12
  fs::path pictures(int count) const {
    const BoardScene scene{.lens = test_lens()};
    const fs::path folder = folder_.path() / "pictures";
    fs::create_directory(folder);
    int number = 0;
    for (const double tilt : {-0.5, 0.0, 0.5}) {
      for (const auto& [x, y] : {std::pair(-0.1, -0.07), std::pair(0.1, -0.07),
                                 std::pair(-0.1, 0.07), std::pair(0.1, 0.07)}) {
        if (number == count) {
          return folder;
        }
        const Picture picture =
            board_picture(scene, board_at({x, y, 0.3}, tilt, x * 3, 0.2 * number),
                          1U + static_cast<unsigned>(number));
        const std::vector<std::byte> png =
            encode_grey_png(picture.width, picture.height, picture.samples);
        put(folder / (std::to_string(100 + number++) + ".png"),
            {reinterpret_cast<const char*>(png.data()), png.size()});
      }
    }
    return folder;
  }

  TemporaryFolder folder_;
};

TEST_F(CalibrateBoardCommand, FindsTheLensFromPicturesAndKeepsIt) {
  const fs::path folder = pictures(12);
  const std::string data = (folder_.path() / "data").string();
  fs::create_directory(data);
  const json found = json::parse(run(
      0, {"calibrate", "--board", folder.string(), "--json", "--keep", "cam/1", "--data", data}));
  EXPECT_TRUE(found["accepted"]);
  EXPECT_NEAR(found["lens"]["fx"].get<double>(), 540, 0.54);
  EXPECT_NEAR(found["lens"]["fy"].get<double>(), 537, 0.54);
  EXPECT_NEAR(found["lens"]["k1"].get<double>(), -0.12, 0.004);
  EXPECT_EQ(found["lens"]["width"], 640);
  const json kept = json::parse(content_of(fs::path(data) / "lenses" / "cam_1.json"));
  EXPECT_EQ(kept["serial"], "cam/1");
  EXPECT_EQ(kept["fx"], found["lens"]["fx"]);

  const std::string said = run(0, {"calibrate", "--board", folder.string()});
  EXPECT_NE(said.find("12 pictures"), std::string::npos) << said;
}

TEST_F(CalibrateBoardCommand, SaysWhyALensIsNotKnown) {
  const fs::path some = pictures(4);
  const json refused = json::parse(run(1, {"calibrate", "--board", some.string(), "--json"}));
  EXPECT_FALSE(refused["accepted"]);
  EXPECT_EQ(refused["reason"], "a board was seen in 4 pictures: at least 5 have to show it");
  EXPECT_NE(run(2, {"calibrate", "--board", some.string(), "--square-mm", "14.9"})
                .find("does not depend on the squares' side"),
            std::string::npos);
  EXPECT_NE(run(2, {"calibrate", "--board", "--simulate-laser", "--square-mm", "14.9", "--data",
                    folder_.path().string()})
                .find("does not depend on the squares' side"),
            std::string::npos);
  put(some / "120.png", "no picture");
  EXPECT_NE(run(1, {"calibrate", "--board", some.string()}).find("120.png"), std::string::npos);
  EXPECT_NE(run(1, {"calibrate", "--board", (folder_.path() / "none").string()}).find("no PNG"),
            std::string::npos);
}

TEST_F(CalibrateBoardCommand, FindsTheLensOfTheRigsCameraAndKeepsIt) {
  const std::string data = (folder_.path() / "data").string();
  fs::create_directory(data);
  const json found =
      json::parse(run(0, {"calibrate", "--board", "--simulate-laser", "--simulate-lens",
                          "--simulate-speed", "100", "--json", "--data", data}));
  EXPECT_TRUE(found["accepted"]);
  EXPECT_NEAR(found["lens"]["fx"].get<double>(), 682.4 * 1.012, 0.7);
  EXPECT_NEAR(found["lens"]["k1"].get<double>(), -0.06, 0.003);
  EXPECT_TRUE(fs::exists(fs::path(data) / "lenses" / "simulated-laser.json"));
}

TEST_F(CalibrateBoardCommand, PrintsTheBoard) {
  const fs::path pdf = folder_.path() / "board.pdf";
  run(0, {"calibrate", "--print-board", pdf.string(), "--paper", "letter"});
  EXPECT_TRUE(content_of(pdf).starts_with("%PDF-1.4\n"));
  run(2, {"calibrate", "--print-board", pdf.string(), "--board", "x"});
}

}  // namespace
}  // namespace octurn
