// Makes scans for tests and benchmarks.
//
//   make_scans room FOLDER POSES          a chamber, seen in few samples
//   make_scans large-room FOLDER POSES    a room of 6 x 5 x 2.5 m, seen by a Kinect
//   make_scans turns FOLDER COUNT         turns of a ball, seen in few samples, in
//                                         FOLDER/scan-00, FOLDER/scan-01, ...
//   make_scans kinect-turns FOLDER COUNT  turns of 36 snapshots by a Kinect

#include <iostream>
#include <string>

#include "support/ball_scan.hpp"
#include "support/room_scan.hpp"

namespace octurn {
namespace {

void write_turn(const std::filesystem::path& folder, int number, int snapshots,
                const Intrinsics& lens) {
  Scan scan{.sensor_name = "test",
            .intrinsics = lens,
            .platform_from_sensor = ball_sensor_pose(),
            .clip = ball_clip};
  scan.clip.max.z() = 0.1 - 0.001 * number;  // makes each model different
  for (int i = 0; i < snapshots; ++i) {
    const double angle =
        ball_angle(static_cast<std::size_t>(i), static_cast<std::size_t>(snapshots));
    scan.shots.push_back({.file = shot_file(i), .angle = angle});
    write_depth_png(folder / shot_file(i), ball_snapshot(angle, lens).frame);
  }
  write_scan(folder, scan);
}

int run(const std::string& kind, const std::filesystem::path& folder, int count) {
  if (kind == "room" || kind == "large-room") {
    write_room_scan(folder, kind == "room" ? small_room() : large_room(), count);
    return 0;
  }
  if (kind != "turns" && kind != "kinect-turns") {
    return 2;
  }
  for (int number = 0; number < count; ++number) {
    const std::string digits = std::to_string(number);
    const std::filesystem::path scan =
        folder / ("scan-" + std::string(digits.size() < 2, '0') + digits);
    if (kind == "turns") {
      write_turn(scan, number, 6, few_samples);
    } else {
      write_turn(scan, number, 36, {});
    }
  }
  return 0;
}

}  // namespace
}  // namespace octurn

int main(int argc, char** argv) {
  constexpr int arguments = 4;
  if (argc != arguments) {
    std::cerr << "usage: make_scans room|large-room|turns|kinect-turns FOLDER COUNT\n";
    return 2;
  }
  return octurn::run(argv[1], argv[2], std::stoi(argv[3]));
}
