// The infrared stream of Octurn's Kinect driver, through OpenNI2, on an emulated USB bus.

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinect/emulated/camera.hpp"
#include "kinect/plain_frames.hpp"
#include "rig/kinect_device.hpp"
#include "sensor/depth_sensor.hpp"
#include "support/patience.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr int different = 5;
constexpr std::size_t columns = 640;

/// The grey level of a pixel of each picture: 1 to 251, which shows its place and the picture.
int grey_of(int picture, std::size_t pixel) {
  return 1 + static_cast<int>((pixel + 37 * static_cast<std::size_t>(picture)) % 251);
}

/// Pictures of 640 x 488 readings of 10 bits, with those grey levels in the upper eight.
std::vector<Readings> pictures() {
  std::vector<Readings> all;
  for (int picture = 0; picture < different; ++picture) {
    Readings& readings = all.emplace_back(EmulatedCamera::infrared_pixels);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      readings[i] = static_cast<std::uint16_t>(4 * grey_of(picture, i) + static_cast<int>(i % 4));
    }
  }
  return all;
}

/// A stream of a device, opened by OpenNI2 as the program does it.
class Stream {
 public:
  Stream(openni::Device& device, openni::SensorType type) {
    EXPECT_EQ(stream_.create(device, type), openni::STATUS_OK);
  }
  ~Stream() { stream_.destroy(); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  openni::Status start() { return stream_.start(); }
  void stop() { stream_.stop(); }

  /// The next frame; nothing if there is none for so long.
  std::optional<openni::VideoFrameRef> next(std::chrono::milliseconds longest = patience) {
    openni::VideoStream* stream = &stream_;
    int ready = 0;
    openni::VideoFrameRef frame;
    if (openni::OpenNI::waitForAnyStream(&stream, 1, &ready, static_cast<int>(longest.count())) !=
            openni::STATUS_OK ||
        stream_.readFrame(&frame) != openni::STATUS_OK) {
      return std::nullopt;
    }
    return frame;
  }

 private:
  openni::VideoStream stream_;
};

std::span<const std::uint8_t> greys_of(const openni::VideoFrameRef& frame) {
  return {static_cast<const std::uint8_t*>(frame.getData()),
          static_cast<std::size_t>(frame.getDataSize())};
}

/// Expects one of the camera's pictures, but for lost pixels. @return their number
std::size_t lost_pixels(const openni::VideoFrameRef& frame) {
  const std::span<const std::uint8_t> greys = greys_of(frame);
  EXPECT_EQ(greys.size(), frame_pixels);
  std::size_t lost = 0;
  std::vector<int> wrong(different);
  for (std::size_t i = 0; i < greys.size(); ++i) {
    lost += greys[i] == lost_infrared ? 1 : 0;
    for (int picture = 0; picture < different && greys[i] != lost_infrared; ++picture) {
      wrong[static_cast<std::size_t>(picture)] += greys[i] != grey_of(picture, i) ? 1 : 0;
    }
  }
  EXPECT_EQ(std::ranges::count(wrong, 0), 1) << "frame " << frame.getFrameIndex();
  return lost;
}

class KinectInfrared : public ::testing::Test {
 protected:
  KinectInfrared() {
    load_sensor_drivers();
    EXPECT_EQ(device_.open("kinect://"), openni::STATUS_OK);
  }
  ~KinectInfrared() override { device_.close(); }

  PacketCounts counts() {
    PacketCounts counts;
    int size = sizeof counts;
    EXPECT_EQ(device_.getProperty(packet_counts_property, &counts, &size), openni::STATUS_OK);
    return counts;
  }

  /// Reads infrared pictures while packets are lost. @return the share of their pixels
  double lost_share(double random_loss, int frames) {
    desk_->random_loss = random_loss;
    Stream stream(device_, openni::SENSOR_IR);
    EXPECT_EQ(stream.start(), openni::STATUS_OK);
    std::size_t lost = 0;
    for (int i = 0; i < frames; ++i) {
      const auto frame = stream.next();
      if (!frame) {
        ADD_FAILURE() << "no frame";
        return 1;
      }
      lost += lost_pixels(*frame);
    }
    return static_cast<double>(lost) / static_cast<double>(frame_pixels) / frames;
  }

  KinectOnDesk desk_{plain_frames(2), pictures()};
  openni::Device device_;
};

TEST_F(KinectInfrared, IsASensorOfItsOwn) {
  const openni::SensorInfo* info = device_.getSensorInfo(openni::SENSOR_IR);
  ASSERT_NE(info, nullptr);
  ASSERT_EQ(info->getSupportedVideoModes().getSize(), 1);
  const openni::VideoMode& mode = info->getSupportedVideoModes()[0];
  EXPECT_EQ(mode.getPixelFormat(), openni::PIXEL_FORMAT_GRAY8);
  EXPECT_EQ(mode.getResolutionX(), 640);
  EXPECT_EQ(mode.getResolutionY(), 480);
  EXPECT_EQ(mode.getFps(), 30);
  EXPECT_NE(device_.getSensorInfo(openni::SENSOR_DEPTH), nullptr);
}

// The driver numbers the frames that it delivers; each frame shows its number on the sensor.
TEST_F(KinectInfrared, ShowsEveryPictureOfTheCameraWithoutItsLastRows) {
  Stream stream(device_, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  for (int index = 0; index < 2 * different;) {
    const auto frame = stream.next();
    ASSERT_TRUE(frame);
    index = frame->getFrameIndex();
    EXPECT_EQ(frame->getSensorType(), openni::SENSOR_IR);
    EXPECT_EQ(frame->getHeight(), 480);
    const std::span<const std::uint8_t> greys = greys_of(*frame);
    ASSERT_EQ(greys.size(), 480 * columns);
    for (std::size_t i = 0; i < greys.size(); ++i) {
      ASSERT_EQ(greys[i], grey_of((index - 1) % different, i)) << index << ", pixel " << i;
    }
  }
  EXPECT_TRUE(desk_->infrared_on);
  EXPECT_FALSE(desk_->depth_on);
  EXPECT_FALSE(desk_->projector_cycles);
  EXPECT_EQ(counts().lost_packets, 0);
}

TEST_F(KinectInfrared, TakesBlackForNoLoss) {
  const KinectOnDesk dark({frame_of(700)}, {Readings(EmulatedCamera::infrared_pixels, 0)});
  openni::Device device;
  ASSERT_EQ(device.open("kinect://0"), openni::STATUS_OK);
  Stream stream(device, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  const auto frame = stream.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::ranges::count(greys_of(*frame), 1), static_cast<std::ptrdiff_t>(frame_pixels));
}

TEST_F(KinectInfrared, ShowsWhichPixelsWereLost) {
  EXPECT_EQ(lost_share(0, 10), 0);
  EXPECT_NEAR(lost_share(0.02, 30), 0.02, 0.01);
  EXPECT_NEAR(lost_share(0.05, 30), 0.05, 0.02);
  EXPECT_GT(counts().partial_frames, 30);
}

TEST_F(KinectInfrared, DropsPicturesOfWhichMoreThanAFifthIsLost) {
  desk_->random_loss = 0.3;
  Stream stream(device_, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  EXPECT_FALSE(stream.next(500ms));
  EXPECT_GT(counts().dropped_frames, 3);
  desk_->random_loss = 0;
  const auto frame = stream.next();
  ASSERT_TRUE(frame);
  EXPECT_LT(lost_pixels(*frame), frame_pixels / 5);
}

TEST_F(KinectInfrared, StartsAfterAStallAndGoesOnAfterASilence) {
  desk_->stalls = 1;
  Stream stream(device_, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  ASSERT_TRUE(stream.next());
  EXPECT_EQ(desk_->stalls, 0);
  desk_->silent = true;
  while (stream.next(200ms)) {  // what arrived before
  }
  desk_->silent = false;
  const auto frame = stream.next();
  ASSERT_TRUE(frame);
  lost_pixels(*frame);
}

TEST_F(KinectInfrared, StopsWithinTwoSecondsThoughTheCameraHangs) {
  Stream stream(device_, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  ASSERT_TRUE(stream.next());
  desk_->camera_hangs = true;
  desk_->keeps_transfers = true;
  const auto begin = steady_clock::now();
  stream.stop();
  EXPECT_LT(steady_clock::now() - begin, 2s);
}

TEST_F(KinectInfrared, IsLostWhenItIsUnplugged) {
  Stream stream(device_, openni::SENSOR_IR);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  ASSERT_TRUE(stream.next());
  desk_.unplug();
  while (stream.next(200ms)) {
  }
  int state = 0;
  int size = sizeof state;
  ASSERT_EQ(device_.getProperty(ONI_DEVICE_PROPERTY_ERROR_STATE, &state, &size), openni::STATUS_OK);
  EXPECT_EQ(state, ONI_DEVICE_STATE_ERROR);
}

TEST_F(KinectInfrared, TakesTurnsWithDepthWhileTheProjectorStaysOn) {
  Stream depth(device_, openni::SENSOR_DEPTH);
  Stream infrared(device_, openni::SENSOR_IR);
  for (int turn = 0; turn < 2; ++turn) {
    ASSERT_EQ(depth.start(), openni::STATUS_OK);
    const auto depths = depth.next();
    ASSERT_TRUE(depths);
    const auto* nearest = static_cast<const std::uint16_t*>(depths->getData());
    EXPECT_NEAR(nearest[0], depth_of(600), 20);
    EXPECT_TRUE(desk_->depth_on);
    EXPECT_FALSE(desk_->infrared_on);
    EXPECT_FALSE(desk_->projector_cycles);
    depth.stop();

    ASSERT_EQ(infrared.start(), openni::STATUS_OK);
    const auto picture = infrared.next();
    ASSERT_TRUE(picture);
    EXPECT_EQ(lost_pixels(*picture), 0);
    EXPECT_TRUE(desk_->infrared_on);
    EXPECT_FALSE(desk_->depth_on);
    EXPECT_FALSE(desk_->projector_cycles);
    infrared.stop();
    EXPECT_FALSE(desk_->infrared_on);
  }
}

TEST_F(KinectInfrared, RefusesToRunBesideDepth) {
  for (const auto& [first, second] : {std::pair(openni::SENSOR_DEPTH, openni::SENSOR_IR),
                                      std::pair(openni::SENSOR_IR, openni::SENSOR_DEPTH)}) {
    Stream runs(device_, first);
    ASSERT_EQ(runs.start(), openni::STATUS_OK);
    ASSERT_TRUE(runs.next());
    Stream waits(device_, second);
    EXPECT_EQ(waits.start(), openni::STATUS_ERROR);
    const std::string error = openni::OpenNI::getExtendedError();
    EXPECT_NE(error.find("one at a time"), std::string::npos) << error;
    EXPECT_TRUE(runs.next());
    runs.stop();
    EXPECT_EQ(waits.start(), openni::STATUS_OK);
    EXPECT_TRUE(waits.next());
  }
}

// Of a picture that becomes brighter downwards, by a grey level every three rows.
TEST(InfraredPictures, AreFilledWherePacketsWereLost) {
  const auto level = [](std::size_t pixel) { return 20 + static_cast<int>(pixel / columns / 3); };
  Readings picture(EmulatedCamera::infrared_pixels);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    picture[i] = static_cast<std::uint16_t>(4 * level(i));
  }
  KinectOnDesk desk({frame_of(700)}, {picture});
  desk->random_loss = 0.05;
  const auto sensor = open_sensor("kinect://");
  for (int count = 0; count < 10; ++count) {
    const std::optional<Picture> seen = sensor->read_infrared({});
    ASSERT_TRUE(seen);
    for (std::size_t i = 0; i < seen->samples.size(); ++i) {
      ASSERT_NEAR(seen->samples[i], level(i), 3) << "pixel " << i;
    }
  }
  EXPECT_GT(sensor->packet_counts()->partial_frames, 5);
}

}  // namespace
}  // namespace octurn
