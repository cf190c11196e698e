#include "octurn/scan_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "octurn/depth_png.hpp"
#include "octurn/platform_pose.hpp"
#include "octurn/units.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A scan.json as the contract prints it, on the small image of tests/golden.
const json contract = json::parse(R"({
  "format": "octurn-scan", "version": 1,
  "sensor": {"name": "Kinect v1", "width": 4, "height": 3, "fx": 575.8, "fy": 570.5, "cx": 320.5,
             "cy": 240.25, "depth_unit_m": 0.0001},
  "calibration": {"platform_from_sensor": [[1, 0, 0, 0.01], [0, -0.6, 0.8, -0.62],
                                           [0, -0.8, -0.6, 0.4], [0, 0, 0, 1]]},
  "clip_m": {"min": [-0.14, -0.15, 0.002], "max": [0.14, 0.15, 0.4]},
  "snapshots": [{"file": "snapshots/000.png", "angle_deg": 0.0},
                {"file": "snapshots/001.png", "angle_deg": 90.0}]})");

/// Every key that a reader needs, and every number in its lists.
const std::array required{"/format",
                          "/version",
                          "/sensor",
                          "/sensor/name",
                          "/sensor/width",
                          "/sensor/height",
                          "/sensor/fx",
                          "/sensor/fy",
                          "/sensor/cx",
                          "/sensor/cy",
                          "/sensor/depth_unit_m",
                          "/calibration",
                          "/calibration/platform_from_sensor",
                          "/clip_m",
                          "/clip_m/min",
                          "/clip_m/max",
                          "/snapshots",
                          "/snapshots/1/file",
                          "/snapshots/1/angle_deg"};
const std::array elements{"/calibration/platform_from_sensor/2",
                          "/calibration/platform_from_sensor/2/1", "/clip_m/min/0", "/clip_m/max/2",
                          "/snapshots/1"};

/// The contract with one value replaced.
std::string with(const char* pointer, const json& value) {
  json changed = contract;
  changed[json::json_pointer(pointer)] = value;
  return changed.dump();
}

/// What a message calls the value at a JSON pointer: "/snapshots/1/file" is snapshots[1].file.
std::string dotted(const std::string& pointer) {
  std::string name;
  std::size_t start = 1;
  while (start <= pointer.size()) {
    const std::size_t end = std::min(pointer.find('/', start), pointer.size());
    const std::string key = pointer.substr(start, end - start);
    const bool is_index = key.find_first_not_of("0123456789") == std::string::npos;
    name += is_index ? "[" + key + "]" : (name.empty() ? key : "." + key);
    start = end + 1;
  }
  return name;
}

void expect_refused(const std::string& text, const std::string& named) {
  const Error error = error_thrown_by([&] { parse_scan(text); });
  EXPECT_EQ(error.code(), "scan-malformed") << text;
  EXPECT_NE(std::string(error.what()).find(named), std::string::npos)
      << error.what() << "\ndoes not name " << named << " of " << text;
}

/// A scan of one snapshot, the golden image.
Scan write_small_scan(const std::filesystem::path& folder) {
  put(folder / "scan.json", contract.dump());
  std::filesystem::create_directory(folder / "snapshots");
  std::filesystem::copy_file(std::filesystem::path(OCTURN_GOLDEN) / "depth_4x3.png",
                             folder / "snapshots" / "000.png");
  return read_scan(folder);
}

TEST(ParseScan, TakesWhatTheContractNames) {
  const Scan scan = parse_scan(contract.dump());

  EXPECT_EQ(scan.sensor_name, "Kinect v1");
  EXPECT_EQ(scan.intrinsics.width, 4);
  EXPECT_EQ(scan.intrinsics.height, 3);
  EXPECT_EQ(scan.intrinsics.fx, 575.8);
  EXPECT_EQ(scan.intrinsics.fy, 570.5);
  EXPECT_EQ(scan.intrinsics.cx, 320.5);
  EXPECT_EQ(scan.intrinsics.cy, 240.25);
  EXPECT_EQ(scan.intrinsics.depth_unit, 0.0001);
  EXPECT_EQ(scan.platform_from_sensor.translation(), Eigen::Vector3d(0.01, -0.62, 0.4));
  EXPECT_EQ(scan.platform_from_sensor.linear().row(1), Eigen::RowVector3d(0.0, -0.6, 0.8));
  EXPECT_EQ(scan.clip.min, Eigen::Vector3d(-0.14, -0.15, 0.002));
  EXPECT_EQ(scan.clip.max, Eigen::Vector3d(0.14, 0.15, 0.4));
  ASSERT_EQ(scan.shots.size(), 2U);
  EXPECT_EQ(scan.shots[1].file, "snapshots/001.png");
  EXPECT_DOUBLE_EQ(scan.shots[1].angle, std::numbers::pi / 2);
}

TEST(ParseScan, PassesOverOtherKeys) {
  json more = contract;
  more["filter"] = "average";
  more["sensor"]["serial"] = "A00362";
  more["snapshots"][0]["time"] = "2026-11-21T08:15:00Z";

  EXPECT_EQ(parse_scan(more.dump()).shots.size(), 2U);
}

TEST(ParseScan, RefusesEachMissingKeyByName) {
  for (const std::string pointer : required) {
    const auto slash = pointer.rfind('/');
    json changed = contract;
    changed[json::json_pointer(pointer.substr(0, slash))].erase(pointer.substr(slash + 1));

    expect_refused(changed.dump(), "\"" + dotted(pointer) + "\" is missing");
  }
}

TEST(ParseScan, RefusesEachValueOfTheWrongKindByName) {
  std::vector<std::string> pointers(required.begin(), required.end());
  pointers.insert(pointers.end(), elements.begin(), elements.end());
  for (const std::string& pointer : pointers) {
    const json& right = contract.at(json::json_pointer(pointer));
    for (const json& wrong : {json(nullptr), json(true), json(-7.5), json("seven"), json::array(),
                              json::object(), json::array({json::array()})}) {
      const bool same_kind = (wrong.is_number() && right.is_number()) ||
                             (wrong.is_string() && right.is_string()) ||
                             (pointer == "/snapshots" && wrong == json::array());
      if (!same_kind) {
        expect_refused(with(pointer.c_str(), wrong), dotted(pointer));
      }
    }
  }
}

TEST(ParseScan, RefusesNumbersOutOfTheirRange) {
  for (const char* side : {"/sensor/width", "/sensor/height"}) {
    for (const json& wrong :
         {json(0), json(1), json(-640), json(640.5), json(8193), json(4294967300), json(1e300)}) {
      expect_refused(with(side, wrong), dotted(side));
    }
  }
  for (const char* length : {"/sensor/fx", "/sensor/fy", "/sensor/depth_unit_m"}) {
    expect_refused(with(length, 0), dotted(length));
    expect_refused(with(length, -575.8), dotted(length));
  }
}

TEST(ParseScan, RefusesAnotherFormatAndAnotherVersion) {
  expect_refused(with("/format", "octurn-mesh"), "\"format\"");
  expect_refused(with("/version", 2), "\"version\" is 2");
  expect_refused(with("/version", 0), "\"version\"");
  expect_refused(with("/version", 1.5), "\"version\"");
}

TEST(ParseScan, RefusesFilesOutsideTheFolder) {
  for (const char* file : {"/etc/passwd", "../000.png", "snapshots/../../000.png", "..", ".", "",
                           "snapshots/", "./..", "//000.png", "snapshots/0\n.png"}) {
    expect_refused(with("/snapshots/1/file", file), "snapshots[1].file");
  }
  expect_refused(with("/snapshots/1/file", std::string("a/../..\0/x", 9)), "snapshots[1].file");
}

TEST(ParseScan, RefusesAMatrixThatIsNoRotation) {
  const char* matrix = "/calibration/platform_from_sensor";
  const json scaled = {{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}};
  const json mirrored = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  const json sheared = {{1, 0.001, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  const json nothing = {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 1}};
  const json projective = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0.1, 1}};
  const json three_rows = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  for (const json& wrong : {scaled, mirrored, sheared, nothing, projective, three_rows}) {
    expect_refused(with(matrix, wrong), dotted(matrix));
  }
}

TEST(ParseScan, TakesARotationRoundedToFiveDigits) {
  const json rounded = {
      {1, 0, 0, 0}, {0, -0.42262, 0.90631, 0}, {0, -0.90631, -0.42262, 0}, {0, 0, 0, 1}};

  EXPECT_NO_THROW(parse_scan(with("/calibration/platform_from_sensor", rounded)));
}

TEST(ParseScan, RefusesAClipBoxWithNothingInside) {
  expect_refused(with("/clip_m/max/1", -0.15), "\"clip_m\"");
  expect_refused(with("/clip_m/min/2", 0.5), "\"clip_m\"");
}

TEST(ParseScan, RefusesAScanWithoutSnapshots) {
  const Error error = error_thrown_by([] { parse_scan(with("/snapshots", json::array())); });

  EXPECT_EQ(error.code(), "scan-empty");
}

TEST(ParseScan, RefusesEveryTruncatedTextAndTrailingBytes) {
  const std::string whole = contract.dump();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    expect_refused(whole.substr(0, size), "not JSON");
  }
  expect_refused(whole + "}", "not JSON");
}

TEST(ParseScan, RefusesWhatIsNoObject) {
  expect_refused("[]", "must be an object");
  expect_refused("7", "must be an object");
  expect_refused("\xff\xfe", "not JSON");
}

TEST(ParseScan, RefusesDeepNesting) {
  const std::string deep(100'000, '[');
  std::string closed = with("/sensor/width", "deep");
  closed.replace(closed.find("\"deep\""), 6, deep + std::string(deep.size(), ']'));

  expect_refused(deep, "nested more than 32 deep");
  expect_refused(closed, "nested more than 32 deep");
}

TEST(ReadScan, SaysWhichFileIsMissing) {
  const TemporaryFolder folder;

  const Error error = error_thrown_by([&] { read_scan(folder.path()); });

  EXPECT_EQ(error.code(), "scan-missing");
  EXPECT_NE(std::string(error.what()).find("scan.json"), std::string::npos);
}

TEST(ReadScan, RefusesAFolderInPlaceOfItsFile) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scan.json");

  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-missing");
}

TEST(ReadScan, RefusesAFileTooLargeToBeOne) {
  const TemporaryFolder folder;
  put(folder.path() / "scan.json", contract.dump());
  std::filesystem::resize_file(folder.path() / "scan.json", 1ULL << 40U);  // a hole, takes no disk

  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-malformed");
}

TEST(ReadSnapshot, IsTheImageSeenFromItsAngle) {
  const TemporaryFolder folder;
  const Scan scan = write_small_scan(folder.path());
  const Shot quarter_turn{.file = "snapshots/000.png", .angle = std::numbers::pi / 2};

  const Snapshot snapshot = read_snapshot(folder.path(), scan, quarter_turn);

  EXPECT_EQ(snapshot.frame.depth[1], 8001);
  EXPECT_EQ(snapshot.intrinsics.fx, 575.8);
  // The sensor stands at (0.01, -0.62, 0.4); the object turned counter-clockwise by 90 degrees sees
  // it come round clockwise, to (-0.62, -0.01, 0.4).
  const Eigen::Vector3d eye = snapshot.object_from_sensor.translation();
  EXPECT_LT((eye - Eigen::Vector3d(-0.62, -0.01, 0.4)).norm(), 1e-12);
}

TEST(ReadSnapshot, SaysWhichFileIsMissing) {
  const TemporaryFolder folder;
  const Scan scan = write_small_scan(folder.path());

  const Error error = error_thrown_by([&] { read_snapshot(folder.path(), scan, scan.shots[1]); });

  EXPECT_EQ(error.code(), "scan-missing");
  EXPECT_NE(std::string(error.what()).find("snapshots/001.png"), std::string::npos);
}

TEST(ReadSnapshot, SaysWhichFileIsDamaged) {
  const TemporaryFolder folder;
  const Scan scan = write_small_scan(folder.path());
  put(folder.path() / "snapshots/001.png", "no image");

  const Error error = error_thrown_by([&] { read_snapshot(folder.path(), scan, scan.shots[1]); });

  EXPECT_EQ(error.code(), "snapshot-malformed");
  EXPECT_NE(std::string(error.what()).find("snapshots/001.png"), std::string::npos);
}

TEST(WriteScan, IsReadBackTheSame) {
  const TemporaryFolder folder;
  const Scan written = parse_scan(contract.dump());

  write_scan(folder.path(), written);
  const Scan read = read_scan(folder.path());

  EXPECT_EQ(read.sensor_name, written.sensor_name);
  EXPECT_EQ(read.intrinsics.cy, written.intrinsics.cy);
  EXPECT_EQ(read.platform_from_sensor.matrix(), written.platform_from_sensor.matrix());
  EXPECT_EQ(read.clip.min, written.clip.min);
  EXPECT_EQ(read.clip.max, written.clip.max);
  ASSERT_EQ(read.shots.size(), 2U);
  EXPECT_EQ(read.shots[0].file, "snapshots/000.png");
  EXPECT_DOUBLE_EQ(read.shots[1].angle, written.shots[1].angle);
}

TEST(WriteScan, WritesTheKeysOfTheContractAndNothingElse) {
  const TemporaryFolder folder;

  write_scan(folder.path(), parse_scan(contract.dump()));

  const json written = json::parse(content_of(folder.path() / "scan.json"));
  EXPECT_EQ(written, contract);
}

TEST(WriteScan, ReplacesWhatIsNoUtf8InASensorsName) {
  const TemporaryFolder folder;
  Scan scan = parse_scan(contract.dump());
  scan.sensor_name = "Kinect\xff";

  write_scan(folder.path(), scan);

  EXPECT_EQ(read_scan(folder.path()).sensor_name, "Kinect\xef\xbf\xbd");
}

TEST(WriteDepthPng, MakesItsFolderAndIsReadBackTheSame) {
  const TemporaryFolder folder;
  const Scan scan = parse_scan(contract.dump());
  const DepthFrame frame{
      .width = 4, .height = 3, .depth = {0, 1, 2, 3, 255, 256, 257, 258, 65535, 8000, 8001, 0}};

  write_depth_png(folder.path() / shot_file(0), frame);

  EXPECT_EQ(read_snapshot(folder.path(), scan, scan.shots[0]).frame.depth, frame.depth);
}

TEST(ShotFile, NumbersWithThreeDigitsOrMore) {
  EXPECT_EQ(shot_file(0), "snapshots/000.png");
  EXPECT_EQ(shot_file(42), "snapshots/042.png");
  EXPECT_EQ(shot_file(999), "snapshots/999.png");
  EXPECT_EQ(shot_file(1000), "snapshots/1000.png");
}

}  // namespace
}  // namespace octurn
