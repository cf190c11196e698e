// Scans by laser line, end to end: `octurn scan --simulate-laser`.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "support/patience.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr double radius = 30;  // mm, of the cylinder
constexpr double height = 50;

using Point = std::array<double, 3>;  // mm

/// Writes an ASCII STL, facet by facet.
class MeshWriter {
 public:
  explicit MeshWriter(const fs::path& file) : file_(file) { file_ << "solid object\n"; }
  ~MeshWriter() { file_ << "endsolid object\n"; }
  MeshWriter(const MeshWriter&) = delete;
  MeshWriter& operator=(const MeshWriter&) = delete;

  void facet(const std::array<Point, 3>& points) {
    file_ << "facet normal 0 0 0\nouter loop\n";
    for (const auto& [x, y, z] : points) {
      file_ << "vertex " << x << ' ' << y << ' ' << z << '\n';
    }
    file_ << "endloop\nendfacet\n";
  }

 private:
  std::ofstream file_;
};

void write_cylinder(const fs::path& file) {
  constexpr int corners = 96;
  MeshWriter mesh(file);
  for (int i = 0; i < corners; ++i) {
    const auto at = [&](int corner, double z) {
      const double angle = 2 * std::acos(-1.0) * corner / corners;
      return Point{radius * std::cos(angle), radius * std::sin(angle), z};
    };
    mesh.facet({at(i, 0), at(i + 1, 0), at(i + 1, height)});
    mesh.facet({at(i, 0), at(i + 1, height), at(i, height)});
    mesh.facet({{{0, 0, height}, at(i, height), at(i + 1, height)}});
    mesh.facet({{{0, 0, 0}, at(i + 1, 0), at(i, 0)}});
  }
}

/// Writes three boxes on and beside each other; the object looks different in each resting
/// position.
void write_boxes(const fs::path& file) {
  MeshWriter mesh(file);
  for (const auto& [low, high] : {std::array<Point, 2>{{{-28, -20, 0}, {28, 20, 22}}},
                                  {{{-28, -20, 22}, {-6, 4, 52}}},
                                  {{{12, 2, 22}, {24, 18, 34}}}}) {
    const auto corner = [&, low = low, high = high](int x, int y, int z) {
      return Point{x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]};
    };
    for (const int side : {0, 1}) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](int a, int b) {
          std::array<int, 3> index{};
          index[static_cast<std::size_t>(axis)] = side;
          index[static_cast<std::size_t>((axis + 1) % 3)] = side ? a : b;
          index[static_cast<std::size_t>((axis + 2) % 3)] = side ? b : a;
          return corner(index[0], index[1], index[2]);
        };
        mesh.facet({at(0, 0), at(1, 0), at(1, 1)});
        mesh.facet({at(0, 0), at(1, 1), at(0, 1)});
      }
    }
  }
}

/// Smallest and largest coordinates of a binary STL, mm.
std::array<std::array<float, 2>, 3> extent_of(const std::string& stl) {
  std::array<std::array<float, 2>, 3> extent{{{1e9F, -1e9F}, {1e9F, -1e9F}, {1e9F, -1e9F}}};
  for (std::size_t facet = 84; facet + 50 <= stl.size(); facet += 50) {
    for (std::size_t number = 0; number < 9; ++number) {
      float value = 0;
      std::memcpy(&value, stl.data() + facet + 12 + 4 * number, sizeof value);
      auto& [low, high] = extent[number % 3];
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  return extent;
}

/// A scan with a quarter of the default camera's pixels, so that it takes seconds.
/// @param object  "cylinder" or "boxes"
std::vector<std::string> laser_scan(const fs::path& folder,
                                    const std::string& object = "cylinder") {
  std::ofstream(folder / "octurn.json")
      << R"({"laser": {"width": 410, "height": 308, "fx": 341.2, "fy": 341.2, "cx": 204.5, "cy": 153.5}})";
  write_cylinder(folder / "cylinder.stl");
  write_boxes(folder / "boxes.stl");
  return {octurn_program(),
          "scan",
          "--simulate-laser=" + (folder / (object + ".stl")).string(),
          "--simulate-speed",
          "100",
          "--config",
          folder / "octurn.json",
          "--data",
          folder / "data",
          "-o",
          folder / "Scan.stl"};
}

/// The folder of a scan once it has that picture; empty if the picture does not appear.
fs::path scan_with(const fs::path& scans, const char* picture) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    std::error_code not_yet;
    for (const fs::directory_entry& scan : fs::directory_iterator(scans, not_yet)) {
      if (fs::exists(scan.path() / "snapshots" / picture)) {
        return scan.path();
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

TEST(LaserScanCommand, MakesAClosedModelOfTheObjectsSize) {
  const TemporaryFolder folder;
  std::vector<std::string> words = laser_scan(folder.path());
  words.insert(words.end(), {"--snapshots", "40", "--leaf-size-mm", "1"});
  Program program(words);
  ASSERT_EQ(program.wait(), 0) << program.errors();
  const std::string stl = content_of(folder.path() / "Scan.stl");
  EXPECT_GT(triangles_of_whole_stl(stl), 1000);
  EXPECT_EQ(open_edges(stl), 0);
  // Half a leaf, and the sagitta of 40 chords in a circle, lines 9 degrees apart: 0.1 mm.
  constexpr double slack = 0.8;
  const auto [x, y, z] = extent_of(stl);
  EXPECT_NEAR(x[0], -radius, slack);
  EXPECT_NEAR(x[1], radius, slack);
  EXPECT_NEAR(y[0], -radius, slack);
  EXPECT_NEAR(y[1], radius, slack);
  EXPECT_NEAR(z[1], height, 2.5);  // the lasers graze the top, so its centre is filled in too high
  const fs::path stored = fs::directory_iterator(folder.path() / "data" / "scans")->path();
  EXPECT_TRUE(fs::exists(stored / "snapshots" / "039-right.png"));
  EXPECT_NE(content_of(stored / "scan.json").find("\"solved\""), std::string::npos);

  // Without options the program's model is the library's, finer than a depth sensor's.
  const fs::path again = folder.path() / "again.stl";
  Program reconstruct({octurn_program(), "reconstruct", stored.string(), "-o", again.string()});
  ASSERT_EQ(reconstruct.wait(), 0) << reconstruct.errors();
  const fs::path by_library = folder.path() / "library.stl";
  Program example({example_program(), stored.string(), by_library.string()});
  ASSERT_EQ(example.wait(), 0) << example.errors();
  EXPECT_TRUE(content_of(by_library) == content_of(again));
  EXPECT_GT(triangles_of_whole_stl(content_of(again)), 2 * triangles_of_whole_stl(stl));
}

TEST(LaserScanCommand, StopsWhenItIsInterruptedAndGoesOnWhereItWas) {
  const TemporaryFolder folder;
  std::vector<std::string> words = laser_scan(folder.path());
  words.insert(words.end(), {"--snapshots", "12", "--leaf-size-mm", "4"});
  fs::path stored;
  for (int status = 0; status == 0;) {  // once more where the scan ended before the signal
    fs::remove_all(folder.path() / "data");
    Program program(words);
    stored = scan_with(folder.path() / "data" / "scans", "002-right.png");
    program.send_signal(SIGKILL);
    status = program.wait();
  }
  ASSERT_FALSE(stored.empty());
  words.insert(words.end(), {"--resume", stored.filename()});
  Program program(words);
  ASSERT_EQ(program.wait(), 0) << program.errors();
  EXPECT_EQ(open_edges(content_of(folder.path() / "Scan.stl")), 0);
  EXPECT_TRUE(fs::exists(stored / "snapshots" / "011-right.png"));
}

// With the default camera, as small pictures show too little of the line on a box seen edge-on.
TEST(LaserScanCommand, ClosesTheUndersideOfAnObjectThatWasTurnedOver) {
  const TemporaryFolder folder;
  std::vector<std::string> words = laser_scan(folder.path(), "boxes");
  std::ofstream(folder.path() / "octurn.json") << "{}";
  words.insert(words.end(), {"--snapshots", "40", "--leaf-size-mm", "1"});
  Program first(words);
  ASSERT_EQ(first.wait(), 0) << first.errors();
  const fs::path stored = fs::directory_iterator(folder.path() / "data" / "scans")->path();
  words.insert(words.end(), {"--pose-of", stored.filename()});
  Program second(words);
  ASSERT_EQ(second.wait(), 0) << second.errors();
  const std::string stl = content_of(folder.path() / "Scan.stl");
  EXPECT_EQ(open_edges(stl), 0);
  const auto scan =
      nlohmann::json::parse(content_of(stored / "builds" / "1" / "scan" / "scan.json"));
  EXPECT_EQ(scan["version"], 2);
  EXPECT_EQ(scan["snapshots"].size(), 80U);
  EXPECT_EQ(scan["snapshots"][79]["files"]["right"], "snapshots/079-right.png");
}

TEST(LaserScanCommand, SaysWhatASimulatedRigHasNot) {
  const TemporaryFolder folder;
  std::vector<std::string> words = laser_scan(folder.path());
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--simulate"}, {"--simulate-wall", "1"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), wrong.begin(), wrong.end());
    Program program(all);
    EXPECT_EQ(program.wait(), 2) << wrong.front();
    EXPECT_NE(program.errors().find(wrong.front()), std::string::npos) << program.errors();
  }
}

// If the scan ignored the configured distortion, the cylinder would be 2 % off and no circle.
TEST(LaserScanCommand, MakesAModelOfThatSizeThroughALensThatDistorts) {
  const TemporaryFolder folder;
  std::vector<std::string> words = laser_scan(folder.path());
  std::ofstream(folder.path() / "octurn.json")
      << R"({"laser": {"width": 410, "height": 308, "fx": 341.2, "fy": 341.2, "cx": 204.5, "cy": 153.5,)"
      << R"( "k1": -0.2, "k2": 0.05}})";
  words.insert(words.end(), {"--snapshots", "40", "--leaf-size-mm", "1"});
  Program program(words);
  ASSERT_EQ(program.wait(), 0) << program.errors();
  const auto [x, y, z] = extent_of(content_of(folder.path() / "Scan.stl"));
  EXPECT_NEAR(x[1] - x[0], 2 * radius, 1);
  EXPECT_NEAR(y[1] - y[0], 2 * radius, 1);
  EXPECT_NEAR(z[1], height, 2.5);
}

}  // namespace
}  // namespace octurn
