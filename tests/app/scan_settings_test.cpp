#include "settings/scan_settings.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "settings/field.hpp"
#include "store/job.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"
#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

using nlohmann::json;

ScanSettings parsed(const char* text) { return settings_from(json::parse(text), {}); }

TEST(ScanSettings, TakesMillimetresAndKeepsMetres) {
  const ScanSettings settings = parsed(R"({"leaf_size_mm": 2, "root_size_mm": 500,
                                           "clip_mm": [-100, -90, 5, 100, 90, 300]})");
  EXPECT_DOUBLE_EQ(settings.leaf_size, 0.002);
  EXPECT_DOUBLE_EQ(settings.root_size, 0.5);
  EXPECT_DOUBLE_EQ(settings.clip.min.y(), -0.09);
  EXPECT_DOUBLE_EQ(settings.clip.max.z(), 0.3);
}

TEST(ScanSettings, KeepsTheDefaultOfAKeyThatIsNotGiven) {
  ScanSettings defaults;
  defaults.frames = 17;
  const ScanSettings settings = settings_from(json{{"snapshots", 5}}, defaults);
  EXPECT_EQ(settings.snapshots, 5);
  EXPECT_EQ(settings.frames, 17);
}

TEST(ScanSettings, ComeBackAsTheyWereWritten) {
  const json written = to_json(ScanSettings{});
  EXPECT_EQ(
      to_json(settings_from(written, parsed(R"({"snapshots": 3, "clip_mm": [0,0,0,1,1,1]})"))),
      written);
  EXPECT_EQ(written["leaf_size_mm"], 1.0);
  EXPECT_EQ(written["clip_mm"], json::parse("[-140.0, -140.0, 5.0, 140.0, 140.0, 400.0]"));
}

TEST(ScanSettings, RefuseWhatIsOutOfRangeAndNameIt) {
  const char* const wrong[] = {
      R"({"snapshots": 0})",
      R"({"snapshots": 401})",
      R"({"snapshots": 2.5})",
      R"({"snapshots": "8"})",
      R"({"snapshots": null})",
      R"({"filter": "kalman"})",
      R"({"filter": 1})",
      R"({"frames": 0})",
      R"({"frames": 1e9})",
      R"({"leaf_size_mm": 0})",
      R"({"leaf_size_mm": -1})",
      R"({"leaf_size_mm": 1001})",
      R"({"leaf_size_mm": []})",
      R"({"threshold_m2": 0})",
      R"({"threshold_m2": true})",
      R"({"root_size_mm": 0})",
      R"({"root_size_mm": 1e300})",
      R"({"clip_mm": [0,0,0,1,1]})",
      R"({"clip_mm": 5})",
      R"({"clip_mm": [0,0,0,1,1,0]})",
      R"({"clip_mm": [0,0,0,1,1,"a"]})",
      R"({"clip_mm": [0,0,0,1,1,1e9]})",
      R"({"platform_from_sensor": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]})",
      R"({"platform_from_sensor": [[1,0,0,0],[0,1,0,0],[0,0,2,0],[0,0,0,1]]})",
      R"({"platform_from_sensor": [[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]})",
      R"({"platform_from_sensor": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]})",
      R"({"platform_from_sensor": [1, 2, 3, 4]})",
  };
  for (const char* const text : wrong) {
    const Error error = error_thrown_by([&] { parsed(text); });
    const std::string key = json::parse(text).begin().key();
    EXPECT_EQ(error.code(), ErrorCode::bad_settings) << text;
    EXPECT_NE(std::string(error.what()).find("\"" + key + "\""), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("must be"), std::string::npos) << error.what();
  }
}

TEST(ScanSettings, RefuseALeafLargerThanTheRoot) {
  EXPECT_EQ(code_thrown_by([] { parsed(R"({"root_size_mm": 100, "leaf_size_mm": 101})"); }),
            "bad-settings");
}

TEST(ScanSettings, RefuseALeafTooSmallForTheRootAndNameTheSmallestThatFits) {
  const char* const text = R"({"root_size_mm": 7000, "leaf_size_mm": 0.1})";
  const Error error = error_thrown_by([&] { parsed(text); });
  EXPECT_EQ(error.code(), ErrorCode::bad_settings);
  EXPECT_NE(std::string(error.what()).find("\"leaf_size_mm\" is 0.1: must be at least 0.107"),
            std::string::npos)
      << error.what();
  const ScanSettings fitting = parsed(R"({"root_size_mm": 7000, "leaf_size_mm": 0.107})");
  EXPECT_EQ(checked_levels(reconstruct_options(fitting, {})), max_levels);
  EXPECT_NO_THROW(parsed(R"({"root_size_mm": 6553.6, "leaf_size_mm": 0.1})"));
}

TEST(ScanSettings, RefuseAClipBoxThinnerThanALeaf) {
  for (const char* const text :
       {R"({"clip_mm": [0, 0, 0, 1e-7, 1e-7, 1e-7]})", R"({"clip_mm": [0, 0, 0, 100, 0.999, 100]})",
        R"({"leaf_size_mm": 300})"}) {
    const Error error = error_thrown_by([&] { parsed(text); });
    EXPECT_EQ(error.code(), ErrorCode::bad_settings);
    EXPECT_NE(std::string(error.what()).find("\"clip_mm\""), std::string::npos) << error.what();
  }
  // A box exactly one leaf thick is accepted despite rounding.
  EXPECT_NO_THROW(parsed(R"({"clip_mm": [-140, -140, 5, -139, -139, 6]})"));
}

ScanSettings stored(const json& settings) {
  return stored_settings_from(JsonValue(settings, "settings", ErrorCode::job_malformed));
}

TEST(ScanSettings, AreReadFromAJobOfVersion01AsThatWroteThem) {
  json settings = json::parse(
      content_of(std::filesystem::path(OCTURN_GOLDEN) / "version-0.1" / "job.json"))["settings"];
  const auto with_later_keys = [](json known) {
    known.update({{"calibrate", "auto"}, {"depth_scale", 1.0}, {"parts", "main"}});
    return known;
  };
  EXPECT_EQ(to_json(stored(settings)), with_later_keys(settings));
  settings["clip_mm"] = {0.0, 0.0, 0.0, 0.5, 0.5, 0.5};  // thinner than its leaves of 4 mm
  EXPECT_EQ(to_json(stored(settings)), with_later_keys(settings));
}

TEST(ScanSettings, AreReadBackAtTheEndsOfTheirStoredRanges) {
  ScanSettings settings;
  for (const Field& field : fields(settings, stored_ranges)) {
    for (const char* const end : {"minimum", "maximum"}) {
      if (field.access.schema.contains(end)) {
        settings = ScanSettings{};
        const double number = field.access.schema[end].get<double>();
        const bool is_whole = field.access.schema["type"] == "integer";
        const json value = is_whole ? json(static_cast<int>(number)) : json(number);
        field.access.read(JsonValue(value, "value", ErrorCode::job_malformed));
        const json written = to_json(settings);
        EXPECT_EQ(to_json(stored(written)), written) << field.key << " " << end;
      }
    }
  }
  settings = ScanSettings{};
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(1000);
  settings.clip = {.min = -corner, .max = corner};
  EXPECT_EQ(to_json(stored(to_json(settings))), to_json(settings));
}

TEST(ScanSettings, OfARequestHaveNarrowerRangesThanThoseOfAFile) {
  for (const json& given :
       {json{{"snapshots", 401}}, json{{"clip_mm", {0, 0, 0, 10'000.1, 1, 1}}}}) {
    EXPECT_EQ(code_thrown_by([&] { parsed(given.dump().c_str()); }), "bad-settings") << given;
    EXPECT_NO_THROW(stored(given)) << given;
  }
}

TEST(BuildSettings, ReadEditsAndWriteThem) {
  const json given = json::parse(R"({"cut_mm": [[0, 3, 4, 50], [0, 0, -1, -5]],
      "erase_mm": [[1, 2, 3, 4]], "lay_mm": [0, 0, 2, 1, 2, 70], "scale": 0.5,
      "max_triangles": 5000})");
  const BuildSettings settings = build_settings_from(given, {});
  const ModelEdits& edits = settings.edits.edits;
  ASSERT_EQ(edits.cuts.size(), 2U);
  EXPECT_TRUE(edits.cuts[0].normal.isApprox(Eigen::Vector3d(0, 0.6, 0.8)));
  EXPECT_DOUBLE_EQ(edits.cuts[0].distance, 0.05);
  EXPECT_EQ(edits.erased,
            std::vector({ErasedBall{.centre = {0.001, 0.002, 0.003}, .radius = 0.004}}));
  EXPECT_EQ(edits.lay, (LaidSide{.down = Eigen::Vector3d::UnitZ(), .point = {0.001, 0.002, 0.07}}));
  const json written = to_json(settings);
  EXPECT_EQ(written["lay_mm"], json::parse("[0.0, 0.0, 1.0, 1.0, 2.0, 70.0]"));
  EXPECT_EQ(to_json(build_settings_from(written, {})), written);
  const json unchanged = to_json(BuildSettings{});
  EXPECT_EQ(unchanged["cut_mm"], json::array());
  EXPECT_EQ(unchanged["lay_mm"], nullptr);
  EXPECT_EQ(to_json(build_settings_from(unchanged, settings)), unchanged);
}

TEST(BuildSettings, RefuseEditsThatAreImpossible) {
  for (const char* const wrong :
       {R"({"cut_mm": [0, 0, 1, 50]})", R"({"cut_mm": [[0, 0, 1]]})",
        R"({"cut_mm": [[0, 0, 0, 5]]})", R"({"cut_mm": [[0, 0, 1, 1e9]]})", R"({"cut_mm": null})",
        R"({"erase_mm": [[0, 0, 0, 0]]})", R"({"lay_mm": [0, 0, 0, 1, 2, 3]})",
        R"({"lay_mm": [0, 0, 1]})", R"({"scale": 0})", R"({"scale": -1})",
        R"({"max_triangles": 1})", R"({"method": "intersection", "cut_mm": [[0, 0, 1, 50]]})",
        R"({"method": "intersection", "erase_mm": [[0, 0, 1, 50]]})",
        R"({"method": "intersection", "max_triangles": 5000})"}) {
    EXPECT_EQ(code_thrown_by([&] { build_settings_from(json::parse(wrong), {}); }), "bad-settings")
        << wrong;
  }
  EXPECT_NO_THROW(build_settings_from(
      json::parse(R"({"method": "intersection", "cut_mm": [], "scale": 2, "lay_mm": null})"), {}));
  json many = json::array();
  for (int i = 0; i <= 200; ++i) {
    many.push_back({0, 0, 1, i});
  }
  EXPECT_EQ(code_thrown_by([&] {
              build_settings_from(json{{"cut_mm", many}}, {});
            }),
            "bad-settings");
}

TEST(ScanSettings, RefuseAKeyThatIsNone) {
  const Error error = error_thrown_by([] { parsed(R"({"leaf_size": 1})"); });
  EXPECT_EQ(std::string(error.what()), "\"leaf_size\": unknown key");
  EXPECT_NE(error.hint().find("leaf_size_mm"), std::string::npos);
}

TEST(ScanSettings, RefuseWhatIsNoObject) {
  EXPECT_EQ(code_thrown_by([] { parsed("[1]"); }), "bad-settings");
}

}  // namespace
}  // namespace octurn
