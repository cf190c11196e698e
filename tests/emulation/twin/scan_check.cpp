// Runs on the emulated Pi: Octurn's own stepper makes a turn of stops on the chip's GPIO lines, and
// at each stop Octurn's own Kinect driver takes a frame through libusb and the kernel.
//
// usage: scan_check STOPS FILE: writes the depth images to FILE, one after the other: 640 x 480
// values in units of 0.1 mm, little-endian 16 bits. If the Kinect is gone, it waits for it.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "kinect/kinect.hpp"
#include "octurn/error.hpp"
#include "turntable/stepper.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

/// The Kinect's stream, and its newest frame.
class Watch {
 public:
  explicit Watch(Kinect& kinect)
      : kinect_(kinect),
        depths_(depth_table(kinect.parameters())),
        stream_([this](const std::stop_token& stop) {
          kinect_.stream(kinect_.use(), depth_camera, stop,
                         [this](const RawFrame& frame) { keep(frame); });
          const std::lock_guard lock(mutex_);
          ended_ = true;
          came_.notify_all();
        }) {}

  /// Waits for a frame whose transfer began after that time. @return its depths; none if the Kinect
  /// is gone
  std::vector<std::uint16_t> frame_after(Clock::time_point time) {
    std::unique_lock lock(mutex_);
    came_.wait(lock, [&] { return ended_ || time_ > time; });
    return ended_ ? std::vector<std::uint16_t>() : depth_;
  }

 private:
  /// Passes over frames that lost packets.
  void keep(const RawFrame& frame) {
    if (std::ranges::find(frame.readings, lost_reading) != frame.readings.end()) {
      return;
    }
    const std::lock_guard lock(mutex_);
    depth_.clear();
    for (const std::uint16_t reading : frame.readings) {
      depth_.push_back(depths_[reading]);
    }
    time_ = frame.time;
    came_.notify_all();
  }

  Kinect& kinect_;
  DepthTable depths_;
  std::mutex mutex_;  // guards the members that follow
  std::condition_variable came_;
  std::vector<std::uint16_t> depth_ = {};
  Clock::time_point time_ = {};
  bool ended_ = false;
  std::jthread stream_;  // the last member: it joins before the members that it uses are destroyed
};

/// The times of STEP's rising edges, in moves of the same number of pulses.
class PulseTimes {
 public:
  explicit PulseTimes(int pulses_in_move)
      : pulses_in_move_(static_cast<std::size_t>(pulses_in_move)) {}

  /// Wraps a function that sets lines, to record the edges. This object must outlive the result.
  Stepper::SetLine watching(Stepper::SetLine set_line) {
    return [this, set_line = std::move(set_line)](Stepper::Line line, bool high) {
      set_line(line, high);
      if (line == Stepper::Line::step && high) {
        rises_.push_back(Clock::now());
      }
    };
  }

  /// The delay of each interval between pulses, relative to the shortest interval at the same index
  /// of all moves; sorted. No pulse is early, so the shortest interval is close to the planned one.
  std::vector<Clock::duration> lateness() const {
    std::vector<Clock::duration> late;
    const std::size_t moves = rises_.size() / pulses_in_move_;
    for (std::size_t pulse = 1; pulse < pulses_in_move_; ++pulse) {
      std::vector<Clock::duration> intervals;
      for (std::size_t move = 0; move < moves; ++move) {
        const std::size_t at = move * pulses_in_move_ + pulse;
        intervals.push_back(rises_[at] - rises_[at - 1]);
      }
      for (const Clock::duration interval : intervals) {
        late.push_back(interval - std::ranges::min(intervals));
      }
    }
    std::ranges::sort(late);
    return late;
  }

 private:
  std::size_t pulses_in_move_;
  std::vector<Clock::time_point> rises_;
};

/// Waits until a Kinect can be opened.
std::unique_ptr<Kinect> open_kinect() {
  for (;;) {
    try {
      return std::make_unique<Kinect>(0);
    } catch (const Error& error) {
      std::cout << error.what() << std::endl;
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
  }
}

/// Takes frames that show the platform as it is from now on. Reopens a Kinect that is lost
/// meanwhile.
class Eye {
 public:
  std::vector<std::uint16_t> look() {
    const auto begin = Clock::now();
    std::vector<std::uint16_t> depth = watch_->frame_after(begin);
    while (depth.empty()) {
      std::cout << "Kinect lost" << std::endl;
      watch_.reset();
      kinect_ = open_kinect();
      watch_ = std::make_unique<Watch>(*kinect_);
      std::cout << "Kinect found" << std::endl;
      depth = watch_->frame_after(begin);
    }
    return depth;
  }

  Kinect& kinect() { return *kinect_; }

 private:
  std::unique_ptr<Kinect> kinect_ = open_kinect();
  std::unique_ptr<Watch> watch_ = std::make_unique<Watch>(*kinect_);
};

void scan(int stops, const char* file) {
  const StepperSettings settings;
  PulseTimes pulses(to_motion(settings).steps_per_turn / stops);
  Stepper stepper(settings, pulses.watching(open_gpio_lines(settings)));
  Eye eye;
  std::ofstream images(file, std::ios::binary);
  const auto begin = Clock::now();
  for (int stop = 0; stop < stops; ++stop) {
    stepper.move_to(std::int64_t{stop} * stepper.steps_per_turn() / stops, {});
    const std::vector<std::uint16_t> depth = eye.look();
    images.write(reinterpret_cast<const char*>(depth.data()),
                 static_cast<std::streamsize>(depth.size() * sizeof depth[0]));
    std::cout << "STOP " << stop << std::endl;
  }
  const std::chrono::duration<double> seconds = Clock::now() - begin;
  std::cout << "seconds " << seconds.count() << ", late pulses " << stepper.late().count
            << ", damaged frames " << eye.kinect().packet_counts().partial_frames << ", tilt "
            << (eye.kinect().tilt() ? "told" : "not told") << std::endl;
  const std::vector<Clock::duration> late = pulses.lateness();
  const auto us = [&](std::size_t share) {
    return std::chrono::duration<double, std::micro>(late[(late.size() - 1) * share / 100]).count();
  };
  std::cout << "pulses late by, us: half " << us(50) << ", 99 of 100 " << us(99) << ", all "
            << us(100) << std::endl;
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  int stops = 0;
  if (argc != 3 ||
      std::from_chars(argv[1], argv[1] + std::strlen(argv[1]), stops).ec != std::errc() ||
      stops < 1) {
    std::cerr << "usage: scan_check STOPS FILE" << std::endl;
    return 2;
  }
  try {
    octurn::scan(stops, argv[2]);
    return 0;
  } catch (const octurn::Error& error) {
    std::cout << to_string(error.code()) << ": " << error.what() << std::endl;
    return 1;
  }
}
