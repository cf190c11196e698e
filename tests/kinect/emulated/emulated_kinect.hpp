#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace octurn {

enum class KinectModel { k1414, k1473, for_windows };

/// The state of an emulated Kinect: its model, its faults, and the commands it has received. It
/// lies in a file that the test and the programs under test map, so that a test can unplug the
/// device while a program streams. Every member is atomic and lock-free.
///
/// The folder in the environment variable `OCTURN_EMULATED_KINECT` holds this state as `kinect`,
/// in `frames` the sequence of frames that it repeats, each of 640 x 480 16-bit readings, and in
/// `infrared`, if it is there, that of its infrared pictures, each of 640 x 488.
struct EmulatedKinect {
  std::atomic<bool> plugged = true;
  std::atomic<int> plugged_times = 1;  // handles opened before the last plugging stay dead
  std::atomic<KinectModel> model = KinectModel::k1414;
  std::atomic<float> baseline_cm = 7.5F;
  std::atomic<float> reference_distance_cm = 120;
  std::atomic<float> reference_pixel_cm = 0.1042F;
  std::atomic<std::uint16_t> shift = 200;
  // Left, up, forward; 819 counts per g.
  std::array<std::atomic<std::int16_t>, 3> acceleration = {0, 819, 0};
  std::atomic<double> speed = 1;  // as a multiple of 30 frames a second

  std::atomic<bool> silent = false;
  std::atomic<bool> is_hasty = false;  // what no transfer waits for is lost, as in the world
  std::atomic<int> interruptions = 0;  // of the next waits for events, as by signals
  // Every `loss_period`-th frame loses `lost_packets` packets from `first_lost` on; the loss may
  // extend into the next frame.
  std::atomic<int> loss_period = 1;
  std::atomic<int> first_lost = 0;
  std::atomic<int> lost_packets = 0;
  std::atomic<int> cut_packet = -1;     // this packet of every `loss_period`-th frame is truncated
  std::atomic<double> random_loss = 0;  // share of packets that are lost, each by itself
  std::atomic<int> burst = 0;           // packets that are lost together, about once a second

  // Faults of control transfers. Those counted by number end by themselves.
  std::atomic<int> not_ready = 0;  // times that each reply of the camera is asked for in vain
  std::atomic<int> short_replies = 0;
  std::atomic<int> stale_replies = 0;  // the reply before is repeated
  std::atomic<int> stalls = 0;
  std::atomic<bool> camera_hangs = false;  // answers no control transfer
  std::atomic<bool> motor_hangs = false;
  std::atomic<bool> keeps_transfers = false;  // does not give back cancelled ones
  std::atomic<int> audio_resets = 0;
  // Times that the bus is still listed without the audio part, which vanishes after a reset.
  std::atomic<int> audio_absences = 0;

  std::atomic<int> frames_sent = 0;
  std::atomic<int> frames_damaged = 0;
  std::atomic<int> video_starts = 0;
  std::atomic<int> stream_priority = 0;  // real-time, of the thread that takes the packets
  std::atomic<bool> near_mode = false;
  std::atomic<bool> depth_on = false;
  std::atomic<bool> infrared_on = false;
  std::atomic<bool> projector_cycles = true;  // goes off and on where it sees no dots
};

static_assert(std::atomic<double>::is_always_lock_free);

inline constexpr const char* emulated_kinect_variable = "OCTURN_EMULATED_KINECT";

}  // namespace octurn
