#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "core/io/scan_json.hpp"
#include "octurn/scan_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

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

/// The text of `contract` with one value replaced.
std::string with(const char* pointer, const json& value) {
  json changed = contract;
  changed[json::json_pointer(pointer)] = value;
  return changed.dump();
}

/// The name in messages of the value at a JSON pointer: "/snapshots/1/file" is snapshots[1].file.
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
  EXPECT_EQ(error.code(), ErrorCode::scan_malformed) << text;
  EXPECT_NE(std::string(error.what()).find(named), std::string::npos)
      << error.what() << "\ndoes not name " << named << " of " << text;
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
    for (const json& wrong : {json(0), json(-575.8), json(1e-10), json(1e6), json(1e300)}) {
      expect_refused(with(length, wrong), dotted(length));
    }
  }
  for (const char* centre : {"/sensor/cx", "/sensor/cy"}) {
    expect_refused(with(centre, 8193), dotted(centre));
    expect_refused(with(centre, -1e300), dotted(centre));
  }
}

TEST(ParseScan, RefusesPlacesBeyondAThousandKilometres) {
  for (const char* place : {"/calibration/platform_from_sensor/1/3", "/clip_m/max/2"}) {
    expect_refused(with(place, 1'000'001), dotted(place));
    expect_refused(with(place, 1e300), dotted(place));
    EXPECT_NO_THROW(parse_scan(with(place, 1'000'000)));
  }
  expect_refused(with("/clip_m/min/0", -1e300), "clip_m.min[0]");
}

TEST(ParseScan, TakesLensesWhosePixelsStayFinite) {
  json widest = contract;
  widest["sensor"]["fx"] = 100'000;
  widest["sensor"]["fy"] = 1;
  widest["sensor"]["cx"] = -8192;
  widest["sensor"]["cy"] = 8192;
  widest["sensor"]["depth_unit_m"] = 1e-9;
  EXPECT_NO_THROW(parse_scan(widest.dump()));
}

TEST(ParseScan, RefusesAnotherFormatAndAnotherVersion) {
  expect_refused(with("/format", "octurn-mesh"), "\"format\"");
  expect_refused(with("/version", 3), "\"version\" is 3");
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

  EXPECT_EQ(error.code(), ErrorCode::scan_empty);
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

const json optics =
    json::parse(R"({"fx": 590.5, "fy": 591, "cx": 332, "cy": 246, "k1": -0.06, "k2": 0.01,
                                    "depth_scale": 1.012, "depth_offset_per_m": 0.002})");

TEST(ParseScan, TakesOpticsThatWereKnown) {
  EXPECT_FALSE(parse_scan(contract.dump()).optics);
  const Scan scan = parse_scan(with("/sensor/optics", optics));
  ASSERT_TRUE(scan.optics);
  EXPECT_EQ(scan.optics->value.fy, 591);
  EXPECT_EQ(scan.optics->value.k1, -0.06);
  EXPECT_EQ(scan.optics->value.depth_offset_per_m, 0.002);
  EXPECT_EQ(scan.optics->sigma.fx, 0) << "earlier versions did not write it";
  const Intrinsics lens = model_intrinsics(scan, scan.shots.front());
  EXPECT_EQ(lens.cx, 332);
  EXPECT_DOUBLE_EQ(lens.depth_unit, 0.0001012);
  EXPECT_EQ(scan.intrinsics.cx, 320.5);  // as the sensor tells
}

TEST(ParseScan, TakesTheSigmasOfOpticsAndScale) {
  json known = optics;
  known["sigma"] = optics;
  known["sigma"]["fx"] = 0.75;
  known["sigma"]["k1"] = 0.01;
  const Scan scan = parse_scan(with("/sensor/optics", known));
  EXPECT_EQ(scan.optics->sigma.fx, 0.75);
  EXPECT_EQ(scan.scale_sigma, unknown_scale_sigma);
  EXPECT_EQ(parse_scan(with("/sensor/scale_sigma", 0.0015)).scale_sigma, 0.0015);
  expect_refused(with("/sensor/scale_sigma", -1), "sensor.scale_sigma");
  EXPECT_FALSE(scan.sensor_on_for);
  EXPECT_EQ(parse_scan(with("/sensor/on_for_s", 620)).sensor_on_for, 620);
  expect_refused(with("/sensor/on_for_s", -1), "sensor.on_for_s");
}

TEST(ParseScan, RefusesOpticsThatAreIncompleteOrOutOfBounds) {
  for (const auto& [key, value] : optics.items()) {
    json broken = optics;
    broken.erase(key);
    expect_refused(with("/sensor/optics", broken), "sensor.optics." + key);
    broken[key] = 1e9;
    expect_refused(with("/sensor/optics", broken), "sensor.optics." + key);
  }
}

TEST(ParseScan, PrefersSolvedOpticsToKnownOnes) {
  json solved = optics;
  solved["fx"] = 580;
  solved["sigma"] = optics;
  solved["sigma"]["k1"] = 0.01;
  json changed = json::parse(with("/sensor/optics", optics));
  changed["calibration"]["solved"] = {
      {"platform_from_sensor", contract["calibration"]["platform_from_sensor"]},
      {"sigma_mm", 0.1},
      {"sigma_deg", 0.1},
      {"before_mm", 1},
      {"after_mm", 0.5},
      {"optics", solved}};
  const Scan scan = parse_scan(changed.dump());
  EXPECT_EQ(model_intrinsics(scan, scan.shots.front()).fx, 580);
  EXPECT_EQ(scan.solved->optics->sigma.k1, 0.01);
  changed["calibration"]["solved"]["optics"].erase("sigma");
  expect_refused(changed.dump(), "calibration.solved.optics.sigma");
}

}  // namespace
}  // namespace octurn
