#include "capture/take_depth_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "app/few_snapshots.hpp"
#include "app/wrapped_sensor.hpp"

namespace octurn {
namespace {

constexpr std::size_t pixels = std::size_t{640} * 480;
constexpr std::size_t lost_rows = std::size_t{640} * 20;

/// A simulated sensor whose frames lose some rows on the way.
class LossySensor final : public WrappedSensor {
 public:
  /// @param first  pixel that the frame of that number loses; so many rows follow
  LossySensor(std::size_t (*first)(int frame), int& frames)
      : WrappedSensor(open_sensor("octurn-simulator://?speed=20&noise=0&pattern=0")),
        first_(first),
        frames_(frames) {}

  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    std::optional<TimedFrame> timed = WrappedSensor::read(stop);
    timed->time = std::chrono::steady_clock::now();  // none is from before the platform stood
    timed->lost.resize(lost_rows);
    std::iota(timed->lost.begin(), timed->lost.end(), first_(frames_++));
    for (const std::size_t pixel : timed->lost) {
      timed->frame.depth[pixel] = 0;
    }
    return timed;
  }

 private:
  std::size_t (*first_)(int frame);
  int& frames_;
};

/// A depth image, and the number of frames that were read for it.
struct Taken {
  DepthFrame image = {};
  int frames = 0;
};

Taken take_lossy(DepthFilter filter, std::size_t (*first)(int frame)) {
  Taken taken;
  ScanSettings settings = few_snapshots();
  settings.filter = filter;
  settings.frames = 3;
  RigOptions options{.sensor_uri = "octurn-simulator://", .speed = 20};
  options.open_sensor = [&](const std::string&) {
    return std::make_unique<LossySensor>(first, taken.frames);
  };
  Rig rig(options);
  taken.image = take_depth_image(rig, {}, settings, {}, {}).value();
  return taken;
}

DepthFrame whole_image() {
  const auto sensor = open_sensor("octurn-simulator://?speed=20&noise=0&pattern=0");
  return sensor->read({}).value().frame;
}

constexpr std::size_t middle = pixels / 2;
std::size_t each_elsewhere(int frame) {
  return middle + lost_rows * static_cast<std::size_t>(frame % 3);
}
std::size_t always_there(int /*frame*/) { return middle; }

TEST(TakeDepthImage, TakesWhatAFrameLostFromTheOthers) {
  const DepthFrame whole = whole_image();
  for (const DepthFilter filter : {DepthFilter::average, DepthFilter::average_discard}) {
    const Taken taken = take_lossy(filter, each_elsewhere);
    EXPECT_TRUE(taken.image.depth == whole.depth) << to_string(filter);
    EXPECT_EQ(taken.frames, 3);
  }
}

TEST(TakeDepthImage, TakesMoreFramesForPixelsThatAllHaveLost) {
  const Taken taken = take_lossy(DepthFilter::basic, each_elsewhere);
  EXPECT_TRUE(taken.image.depth == whole_image().depth);
  EXPECT_EQ(taken.frames, 2);
}

TEST(TakeDepthImage, TakesTenMoreAtMost) {
  const Taken taken = take_lossy(DepthFilter::average, always_there);
  EXPECT_EQ(taken.frames, 13);
  const auto lost = std::span(taken.image.depth).subspan(middle, lost_rows);
  EXPECT_TRUE(std::ranges::all_of(lost, [](std::uint16_t depth) { return depth == 0; }));
}

}  // namespace
}  // namespace octurn
