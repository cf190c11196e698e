#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "store/job_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A quality with two reasons: cut at the top, in two places, and little seen, without a place.
Quality quality_with_places() {
  return {.verdict = Verdict::look,
          .reasons = {{.code = "cut-by-box",
                       .detail = "the object reaches through the top",
                       .hint = "Make the scanned space larger.",
                       .parameters = {{"side", "top"}, {"object_side", 2.0}},
                       .places = {{0.010, -0.020, 0.090}, {0.014, -0.020, 0.090}}},
                      {.code = "little-seen", .detail = "30 %", .hint = "Scan again."}}};
}

TEST(QualityJson, GivesPlacesInMillimetresAndNoneWhereThereAreNone) {
  const json written = to_json(quality_with_places());
  EXPECT_EQ(written["verdict"], "look");
  EXPECT_EQ(written["reasons"][0]["places_mm"], json::parse("[[10, -20, 90], [14, -20, 90]]"));
  EXPECT_FALSE(written["reasons"][1].contains("places_mm"));
}

TEST(QualityJson, GivesTheValuesOfAReasonByTheirNames) {
  const json written = to_json(quality_with_places());
  EXPECT_EQ(written["reasons"][0]["parameters"],
            json::parse(R"({"object_side": 2, "side": "top"})"));
  EXPECT_FALSE(written["reasons"][1].contains("parameters")) << "as version 0.1 wrote it";
}

TEST(QualityJson, ReadsBackWhatItWrote) {
  const json written = to_json(quality_with_places());
  EXPECT_EQ(to_quality(JsonValue(written, "quality", ErrorCode::job_malformed)),
            quality_with_places());
}

TEST(QualityJson, HasTheExpectedSizeErrorIfThereIsOne) {
  Quality quality = quality_with_places();
  EXPECT_FALSE(to_json(quality).contains("size_error"));
  quality.size_error = SizeError{.length = 0.15, .error = 0.0005};
  const json written = to_json(quality);
  EXPECT_EQ(written["size_error"], json::parse(R"({"mm": 0.5, "of_mm": 150})"));
  EXPECT_EQ(to_quality(JsonValue(written, "quality", ErrorCode::job_malformed)), quality);
}

}  // namespace
}  // namespace octurn
