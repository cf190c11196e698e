#include "rig/simulation.hpp"

#include <gtest/gtest.h>

#include "support/thrown_error.hpp"

namespace octurn {
namespace {

TEST(Simulation, IsItsSchemeAloneWhenNothingIsAsked) {
  EXPECT_EQ(simulation_uri({}), "octurn-simulator://");
  const Simulation usual = parse_simulation("octurn-simulator://");
  EXPECT_EQ(usual.mesh_file, "");
  EXPECT_EQ(usual.noise, 1);
  EXPECT_EQ(usual.pattern, 1);
  EXPECT_EQ(usual.unit, 0U);
  EXPECT_EQ(usual.misalignment, 1);
  EXPECT_FALSE(usual.wall.has_value());
  EXPECT_EQ(usual.speed, 1);
  EXPECT_FALSE(usual.silent_after.has_value());
  EXPECT_FALSE(usual.lost_after.has_value());
}

TEST(Simulation, NamesEachSettingInItsUri) {
  const Simulation asked = {.mesh_file = "/home/me/100%?.stl",
                            .seed = 7,
                            .noise = 0.5,
                            .pattern = 0.25,
                            .unit = 3,
                            .misalignment = 0,
                            .wall = 0.75,
                            .speed = 20,
                            .silent_after = 100,
                            .lost_after = 0};

  EXPECT_EQ(simulation_uri(asked),
            "octurn-simulator:///home/me/100%25%3F.stl"
            "?seed=7&noise=0.5&pattern=0.25&unit=3&misalignment=0&wall=0.75&speed=20"
            "&silent-after=100&lost-after=0");
}

TEST(Simulation, ComesBackFromItsUri) {
  const Simulation parsed = parse_simulation(
      "octurn-simulator://"
      "a%20cup%3f.stl?lost-after=3&silent-after=2&speed=0.5&wall=0.6&pattern=3&noise=2&"
      "misalignment=0.5&unit=2&"
      "seed=9");

  EXPECT_EQ(parsed.mesh_file, "a cup?.stl");
  EXPECT_EQ(parsed.seed, 9U);
  EXPECT_EQ(parsed.noise, 2);
  EXPECT_EQ(parsed.pattern, 3);
  EXPECT_EQ(parsed.unit, 2U);
  EXPECT_EQ(parsed.misalignment, 0.5);
  EXPECT_EQ(parsed.wall, 0.6);
  EXPECT_EQ(parsed.speed, 0.5);
  EXPECT_EQ(parsed.silent_after, 2);
  EXPECT_EQ(parsed.lost_after, 3);
}

TEST(Simulation, RefusesWhatItDoesNotKnowByName) {
  const Error error = error_thrown_by([] { parse_simulation("octurn-simulator://?noize=1"); });

  EXPECT_EQ(error.code(), ErrorCode::bad_simulation);
  EXPECT_STREQ(error.what(), "simulator: unknown key \"noize\"");
  EXPECT_NE(error.hint().find("silent-after"), std::string::npos);
}

TEST(Simulation, RefusesValuesOutOfRange) {
  for (const char* query : {"noise",
                            "noise=",
                            "noise=-1",
                            "noise=nan",
                            "noise=inf",
                            "noise=1x",
                            "noise=101",
                            "pattern=-1",
                            "pattern=11",
                            "misalignment=-1",
                            "misalignment=11",
                            "wall=0.2",
                            "wall=7",
                            "wall=",
                            "speed=0",
                            "speed=1001",
                            "seed=-1",
                            "seed=4294967296",
                            "seed=1.5",
                            "silent-after=-1",
                            "lost-after=",
                            "lost-after=2147483648",
                            "=1",
                            "&",
                            "seed=1&&noise=1"}) {
    EXPECT_EQ(
        code_thrown_by([query] { parse_simulation(std::string("octurn-simulator://?") + query); }),
        "bad-simulation")
        << query;
  }
}

TEST(Simulation, RefusesBrokenEscapes) {
  for (const char* path : {"a%", "a%2", "a%zz", "a%00", "a%2-"}) {
    EXPECT_EQ(
        code_thrown_by([path] { parse_simulation(std::string("octurn-simulator://") + path); }),
        "bad-simulation")
        << path;
  }
}

TEST(Simulation, RefusesAPathThatOpenNi2CannotTake) {
  const Simulation fits = {.mesh_file = std::string(255 - 19, 'a')};
  EXPECT_EQ(simulation_uri(fits).size(), 255U);

  const Simulation too_long = {.mesh_file = std::string(256 - 19, 'a')};
  const Error error = error_thrown_by([&] { simulation_uri(too_long); });
  EXPECT_EQ(error.code(), ErrorCode::bad_simulation);
  EXPECT_FALSE(error.hint().empty());
}

TEST(Simulation, SendsThirtyFramesASecondTimesItsSpeed) {
  using std::chrono::microseconds;
  EXPECT_EQ(std::chrono::floor<microseconds>(frame_period({})), microseconds(33'333));
  EXPECT_EQ(std::chrono::floor<microseconds>(frame_period({.speed = 0.25})), microseconds(133'333));
  EXPECT_EQ(std::chrono::floor<microseconds>(frame_period({.speed = 100})), microseconds(333));
}

}  // namespace
}  // namespace octurn
