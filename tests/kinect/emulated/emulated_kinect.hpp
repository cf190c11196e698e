#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace octurn {

enum class KinectModel { k1414, k1473, for_windows };

/// An emulated Kinect: what it is, what is wrong with it, and what it has been told to do. It lies
/// in a file that a test and the programs under test map, so that a test can pull the plug while a
/// program streams. Everything in it is atomic and lock-free.
///
/// The folder that the environment variable `OCTURN_EMULATED_KINECT` names holds this as `kinect`,
/// and as `frames` what it sees over and over: frames of 640 x 480 16-bit readings.
struct EmulatedKinect {
  std::atomic<bool> plugged = true;
  std::atomic<int> plugged_times = 1;  // what was opened before the last time stays dead
  std::atomic<KinectModel> model = KinectModel::k1414;
  std::atomic<float> baseline_cm = 7.5F;
  std::atomic<float> reference_distance_cm = 120;
  std::atomic<float> reference_pixel_cm = 0.1042F;
  std::atomic<std::uint16_t> shift = 200;
  std::array<std::atomic<std::int16_t>, 3> acceleration = {0, 819,
                                                           0};  // 819 to a g: left, up, forward
  std::atomic<double> speed = 1;                                // times 30 frames a second

  std::atomic<bool> silent = false;
  // Of every `loss_period`-th frame, this many packets are lost from this one on, into the next
  // frame if they reach so far.
  std::atomic<int> loss_period = 1;
  std::atomic<int> first_lost = 0;
  std::atomic<int> lost_packets = 0;
  std::atomic<int> cut_packet = -1;  // of every `loss_period`-th frame this one comes too short

  std::atomic<int> frames_sent = 0;
  std::atomic<int> frames_damaged = 0;
  std::atomic<int> video_starts = 0;
  std::atomic<bool> near_mode = false;
  std::atomic<bool> depth_on = false;
};

static_assert(std::atomic<double>::is_always_lock_free);

inline constexpr const char* emulated_kinect_variable = "OCTURN_EMULATED_KINECT";

}  // namespace octurn
