#include "capture/take_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "support/random.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int width = 60;
constexpr int height = 90;

Picture grey(std::uint8_t level) {
  return {.width = width,
          .height = height,
          .samples = std::vector<std::uint8_t>(std::size_t{width} * height, level)};
}

/// A grey picture with a line in `rows` rows.
Picture with_line(std::uint8_t level, int rows, std::uint8_t brightness) {
  Picture picture = grey(level);
  for (int row = 0; row < rows; ++row) {
    picture.samples[static_cast<std::size_t>(row * width + 20)] = brightness;
  }
  return picture;
}

TEST(DarkRoom, IsRefusedWhereAQuarterOfThePictureIsWhite) {
  expect_dark_room(grey(200), "camera");
  Picture lamp = grey(30);
  std::fill_n(lamp.samples.begin(), lamp.samples.size() / 5, std::uint8_t{255});
  expect_dark_room(lamp, "camera");
  std::fill_n(lamp.samples.begin(), lamp.samples.size() / 3, std::uint8_t{255});
  const Error error = error_thrown_by([&] { expect_dark_room(lamp, "camera"); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_blind);
  EXPECT_NE(std::string(error.what()).find("camera: 33 %"), std::string::npos) << error.what();
}

TEST(Line, IsSeenInTheDifferenceAlone) {
  const Picture dark = with_line(20, height, 200);  // a white edge in the scene
  expect_line(dark, with_line(20, height, 250), "left");
  const Error error = error_thrown_by([&] { expect_line(dark, dark, "left"); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_blind);
  EXPECT_NE(std::string(error.what()).find("laser left"), std::string::npos) << error.what();
}

TEST(Line, IsMoreThanNoiseInAFewRows) {
  expect_line(grey(10), with_line(10, 3, 200), "left");
  EXPECT_EQ(code_thrown_by([] { expect_line(grey(10), with_line(10, 2, 200), "left"); }),
            "sensor-blind");
  EXPECT_EQ(code_thrown_by([] { expect_line(grey(10), with_line(10, height, 17), "left"); }),
            "sensor-blind");
}

// As of a red laser in a camera's luminance. What is bright has most of the noise: here the right
// half of the picture, where the line is.
TEST(Line, MayBeDimWhereItStandsOutOfTheNoise) {
  constexpr int columns = 400;
  constexpr int rows = 90;
  constexpr int room = 60;  // grey levels
  Random random(5);
  const auto draw = [&](int line, double deviation) {
    Picture picture{.width = columns, .height = rows};
    for (int pixel = 0; pixel < columns * rows; ++pixel) {
      const int u = pixel % columns;
      const double noise = u < columns / 2 ? 0 : deviation * random.normal();
      const double level = room + (u == 300 ? line : 0) + noise;
      picture.samples.push_back(
          static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L)));
    }
    return picture;
  };
  const auto is_seen = [&](int line, double deviation) {
    const Picture dark = draw(0, deviation);
    try {
      expect_line(dark, draw(line, deviation), "left");
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  EXPECT_TRUE(is_seen(15, 1));
  EXPECT_TRUE(is_seen(33, 3));
  EXPECT_TRUE(is_seen(120, 12));
  for (const double deviation : {1, 3, 6, 12}) {
    EXPECT_FALSE(is_seen(0, deviation)) << deviation;
  }
}

TEST(Line, IsNoLampThatBecameBrighter) {
  EXPECT_EQ(code_thrown_by([] { expect_line(grey(60), grey(90), "left"); }), "sensor-blind");
}

constexpr Rgb paint = {40, 12, 9};
constexpr std::array<std::uint8_t, 2> brightness = {250, 180};  // of the lasers' lines

/// A test camera with two lasers, which tracks which of them are on.
struct Bench {
  std::string log = {};  ///< A and B for on, a and b for off, p for a picture, c for one in colour
  std::array<bool, 2> is_on = {};
  std::array<bool, 2> gives_light = {true, true};
  int late = 0;  ///< pictures that still show the lasers as they were, untold by their stamps
  std::deque<std::array<bool, 2>> exposed = {};  ///< lasers of the pictures to come, oldest first
  int stale = 0;           ///< pictures begun long ago that are handed out first
  int lost_after = 1000;   ///< pictures, then the camera is gone
  int stop_after = 1000;   ///< pictures, then a stop is requested
  std::uint8_t room = 20;  ///< grey levels
  int columns = width;     ///< of its pictures
  bool has_colours = false;
  std::stop_source stop = {};

  bool is_lit() const { return is_on[0] || is_on[1]; }

  class BenchCamera final : public Camera {
   public:
    explicit BenchCamera(Bench& bench) : bench_(bench) {}
    const std::string& name() const override { return name_; }
    std::string serial() const override { return "7"; }
    std::optional<TimedPicture> read_in_colour(const std::stop_token& token) override {
      std::optional<TimedPicture> timed = read(token);
      if (timed && bench_.has_colours) {
        timed->colours.assign(timed->picture.samples.size(), paint);
        bench_.log.back() = bench_.log.back() == 'p' ? 'c' : bench_.log.back();
      }
      return timed;
    }
    std::optional<TimedPicture> read(const std::stop_token& token) override {
      if (token.stop_requested()) {
        return std::nullopt;
      }
      if (bench_.lost_after-- == 0) {
        throw Error(ErrorCode::sensor_lost, "the camera is gone");
      }
      if (bench_.stop_after-- == 0) {
        bench_.stop.request_stop();
        return std::nullopt;
      }
      if (bench_.stale > 0) {
        --bench_.stale;
        return TimedPicture{.picture = grey(255), .begin = {}};
      }
      bench_.log += "p";
      bench_.exposed.push_back(bench_.is_on);
      if (bench_.exposed.size() > static_cast<std::size_t>(bench_.late) + 1) {
        bench_.exposed.pop_front();
      }
      Picture seen = grey(bench_.room);
      for (std::size_t laser = 0; laser < 2; ++laser) {
        if (bench_.exposed.front()[laser] && bench_.gives_light[laser]) {
          seen = with_line(bench_.room, height, brightness[laser]);
        }
      }
      seen.width = bench_.columns;
      return TimedPicture{.picture = std::move(seen), .begin = Clock::now()};
    }

   private:
    Bench& bench_;
    std::string name_ = "camera of a test";
  };

  RigOptions options() {
    LaserSettings told;
    told.lens = {.width = width, .height = height};
    return {.speed = 1000, .laser = told, .open_camera = [this](const LaserSettings&) {
              return CameraAndLasers{
                  .camera = std::make_unique<BenchCamera>(*this),
                  .set_line = [this](std::size_t laser, bool on) {
                    is_on[laser] = on;
                    log += static_cast<char>((on ? 'A' : 'a') + static_cast<char>(laser));
                  }};
            }};
  }
};

std::optional<StopPictures> take(Bench& bench) {
  Rig rig(bench.options());
  rig.lasers().late_pictures = 0;
  return take_pictures(rig, {.index = 0, .position = 3}, bench.stop.get_token(), {});
}

/// The same with a camera whose lateness was not measured.
std::optional<StopPictures> take_first(Bench& bench) {
  Rig rig(bench.options());
  return take_pictures(rig, {.index = 0, .position = 3}, bench.stop.get_token(), {});
}

TEST(TakePictures, PassesOverThePicturesOfALateCamera) {
  for (int late = 0; late <= 4; ++late) {
    SCOPED_TRACE(late);
    Bench bench;
    bench.late = late;
    const auto taken = take_first(bench);
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->pictures.size(), 3U);
    EXPECT_EQ(taken->pictures[0].samples, grey(20).samples);
    EXPECT_EQ(taken->pictures[1].samples, with_line(20, height, brightness[0]).samples);
    EXPECT_EQ(taken->pictures[2].samples, with_line(20, height, brightness[1]).samples);
    EXPECT_FALSE(bench.is_lit());
  }
}

TEST(TakePictures, RefusesACameraThatIsLaterThanFourPictures) {
  for (const int late : {5, 6, 7, 9}) {
    SCOPED_TRACE(late);
    Bench bench;
    bench.late = late;
    const Error error = error_thrown_by([&] { take_first(bench); });
    EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
    EXPECT_NE(std::string(error.what()).find("more than 4 late"), std::string::npos)
        << error.what();
    EXPECT_FALSE(bench.is_lit());
  }
}

TEST(TakePictures, MeasuresHowLateACameraIsByTheLaserThatShows) {
  Bench bench;
  bench.late = 2;
  bench.gives_light[0] = false;
  Rig rig(bench.options());
  const Error error =
      error_thrown_by([&] { take_pictures(rig, {.index = 0, .position = 3}, {}, {}); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_blind);
  EXPECT_NE(std::string(error.what()).find("laser left"), std::string::npos) << error.what();
  EXPECT_EQ(rig.lasers().late_pictures, 2);
}

TEST(TakePictures, MeasuresHowLateACameraIsOnceAfterItWasOpened) {
  Bench bench;
  Rig rig(bench.options());
  ASSERT_TRUE(take_pictures(rig, {.position = 3}, {}, {}));
  bench.log.clear();
  ASSERT_TRUE(take_pictures(rig, {.index = 1, .position = 6}, {}, {}));
  EXPECT_EQ(bench.log, "pApaBpb");
}

TEST(TakePictures, TakesADarkOneAndOneWithEachLaserAlone) {
  Bench bench;
  const auto taken = take(bench);
  EXPECT_EQ(bench.log, "abpApaBpbab");
  ASSERT_TRUE(taken);
  ASSERT_EQ(taken->pictures.size(), 3U);
  EXPECT_EQ(taken->pictures[0].samples, grey(20).samples);
  EXPECT_EQ(taken->pictures[1].samples, with_line(20, height, 250).samples);
  EXPECT_TRUE(taken->colours.empty());
}

TEST(TakePictures, TakesTheDarkOneAloneInColour) {
  Bench bench;
  bench.has_colours = true;
  bench.stale = 2;
  const auto taken = take(bench);
  EXPECT_EQ(bench.log, "abcApaBpbab");
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->colours, std::vector<Rgb>(width * height, paint));
  EXPECT_EQ(taken->pictures[0].samples, grey(20).samples);
}

TEST(TakePictures, LeavesOutPicturesThatBeganTooEarly) {
  Bench bench;
  bench.stale = 5;
  const auto taken = take(bench);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->pictures[0].samples, grey(20).samples);
}

TEST(TakePictures, RefusesACameraWithOldPicturesAlone) {
  Bench bench;
  bench.stale = 1000;
  EXPECT_EQ(code_thrown_by([&] { take(bench); }), "sensor-failed");
}

TEST(TakePictures, RefusesAnotherCamera) {
  Bench bench;
  bench.columns = width / 2;
  EXPECT_EQ(code_thrown_by([&] { take(bench); }), "sensor-other");
}

TEST(TakePictures, NamesTheLaserThatGivesNoLight) {
  Bench bench;
  bench.gives_light[1] = false;
  const Error error = error_thrown_by([&] { take(bench); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_blind);
  EXPECT_NE(std::string(error.what()).find("laser right"), std::string::npos) << error.what();
  EXPECT_FALSE(bench.is_lit());
}

TEST(TakePictures, SwitchesNoLaserOnInABrightRoom) {
  Bench bench;
  bench.room = 255;
  EXPECT_EQ(code_thrown_by([&] { take(bench); }), "sensor-blind");
  EXPECT_EQ(bench.log, "abpab");
}

TEST(TakePictures, HasAllLasersOffWhereverTheCameraIsLost) {
  for (int pictures = 0; pictures < 3; ++pictures) {
    SCOPED_TRACE(pictures);
    Bench bench;
    bench.lost_after = pictures;
    Rig rig(bench.options());
    rig.lasers().late_pictures = 0;
    EXPECT_EQ(code_thrown_by([&] { take_pictures(rig, {.position = 3}, {}, {}); }), "sensor-lost");
    EXPECT_FALSE(bench.is_lit());  // while the rig still holds their lines
  }
}

TEST(TakePictures, HasAllLasersOffWhereverItIsStopped) {
  for (int pictures = 0; pictures < 20; ++pictures) {  // of which 17 measure how late they are
    SCOPED_TRACE(pictures);
    Bench bench;
    bench.stop_after = pictures;
    Rig rig(bench.options());
    EXPECT_FALSE(take_pictures(rig, {.position = 3}, bench.stop.get_token(), {}));
    EXPECT_FALSE(bench.is_lit());
  }
}

TEST(TakePictures, HasAllLasersOffWhileThePlatformTurns) {
  Bench bench;
  Rig rig(bench.options());
  std::string lit_while_turning;
  const ScanObserver observer{
      .on_turn = [&](double) { lit_while_turning += bench.is_lit() ? "lit" : "dark"; }};
  ASSERT_TRUE(take_pictures(rig, {.position = 3}, {}, observer));
  ASSERT_TRUE(take_pictures(rig, {.index = 1, .position = 6}, {}, observer));
  EXPECT_EQ(lit_while_turning, "darkdark");
}

}  // namespace
}  // namespace octurn
