#include "doctor/measure_turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "capture/take_depth_image.hpp"
#include "octurn/error.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int frames_at_look = 6;

// Commanded moves, tried in turn until the platform is seen to move: enough for gears of 1, 4 and
// 12 times the configured gear ratio.
constexpr std::array first_moves_deg{8.0, 30.0, 90.0};
constexpr double seen_move_deg = 10;  // target of each later move, degrees of the platform
constexpr int few_moves = 4;          // the median tolerates two wrong measurements
constexpr int more_moves = 8;         // their median is accurate to some percent
// Search range of the first moves. A platform that turns six times as far as commanded leaves it
// with its first move of 8 degrees, but not with the next, whose size follows from what was seen.
constexpr double widest_deg = 40;
constexpr double expected_deg = 6;  // search range about an expected angle
constexpr double still_deg = 1;     // a first move below it counts as standing still
constexpr double closing_deg = 32;  // search range after a turn: 9 % of it
constexpr double settled_deg = 2;   // a comparison so close does not depend on the pose
constexpr int closing_looks = 3;
constexpr int play_rounds = 3;
constexpr double approach_deg = 15;  // more than the backlash of any gears
// Minimum angle between two compared frames: the sensor's fixed-pattern error is the same in both,
// and biases smaller angles towards 0.
constexpr double apart_deg = 8;
constexpr int looks = 2 * few_moves + more_moves + closing_looks + 3 * play_rounds + 2;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

[[noreturn]] void throw_unseen(const std::string& what) {
  throw Error(ErrorCode::sensor_blind, what,
              "Put an object with corners on the middle of the platform, such as a shoe.");
}

AngleRange around(double deg, double half_width_deg) {
  return {.min_deg = deg - half_width_deg, .max_deg = deg + half_width_deg};
}

/// Moves the motor to commanded angles from the starting position, and compares the depth
/// frames ("looks") taken there.
class TurnMeter {
 public:
  TurnMeter(Rig& rig, PlatformLook view, const std::stop_token& stop,
            const std::function<void(double)>& on_progress)
      : rig_(rig),
        view_(std::move(view)),
        stop_(stop),
        on_progress_(on_progress),
        start_(rig.turntable().position()) {}

  TurnMeasurement measure();

 private:
  void move_to(double commanded_deg);
  DepthFrame look();
  DepthFrame look_at(double commanded_deg);
  DepthFrame look_from_below(double commanded_deg, double rate);
  double seen(const DepthFrame& from, const DepthFrame& to, const AngleRange& range);
  double median_rate(int moves, double move_deg, const AngleRange& range);
  double measure_rate();
  double measure_whole(double rate);
  double measure_play(double rate);
  double measure_return(double rate);

  Rig& rig_;
  PlatformLook view_;
  const std::stop_token& stop_;
  const std::function<void(double)>& on_progress_;
  std::int64_t start_;
  double commanded_deg_ = 0;
  DepthFrame first_look_ = {};
  std::vector<double> sharpness_ = {};
  int looks_done_ = 0;
  double swings_for_s_ = 0;  // at most
};

void TurnMeter::move_to(double commanded_deg) {
  Turntable& turntable = rig_.turntable();
  const double steps = commanded_deg / 360 * turntable.steps_per_turn();
  commanded_deg_ = commanded_deg;
  if (!turntable.move_to(start_ + std::llround(steps), stop_)) {
    throw Stopped{};
  }
}

/// Returns the mean of `frames_at_look` frames of the platform at rest.
DepthFrame TurnMeter::look() {
  const std::vector<DepthFrame> frames =
      read_still_frames(rig_, view_, frames_at_look, stop_, [](const DepthFrame&) {});
  if (frames.empty()) {
    throw Stopped{};
  }
  swings_for_s_ = std::max(swings_for_s_, rig_.settling().time().count());
  on_progress_(std::min(1.0, static_cast<double>(++looks_done_) / looks));
  return merge_frames(frames, DepthFilter::average);
}

DepthFrame TurnMeter::look_at(double commanded_deg) {
  move_to(commanded_deg);
  return look();
}

/// Takes a frame at a commanded angle that is approached forwards, so that the backlash is taken
/// up.
DepthFrame TurnMeter::look_from_below(double commanded_deg, double rate) {
  if (commanded_deg <= commanded_deg_) {
    move_to(commanded_deg - approach_deg / std::abs(rate));
  }
  return look_at(commanded_deg);
}

double TurnMeter::seen(const DepthFrame& from, const DepthFrame& to, const AngleRange& range) {
  const auto rotation = seen_rotation(view_, from, to, range);
  if (!rotation) {
    throw_unseen("there is no object on the platform whose turn could be seen");
  }
  sharpness_.push_back(rotation->sharpness);
  return rotation->deg;
}

/// Makes equal moves forwards. @return median rate: degrees of the platform for each commanded
/// degree
double TurnMeter::median_rate(int moves, double move_deg, const AngleRange& range) {
  std::vector<double> rates;
  DepthFrame before = look();
  for (int move = 0; move < moves; ++move) {
    DepthFrame now = look_at(commanded_deg_ + move_deg);
    rates.push_back(seen(before, now, range) / move_deg);
    before = std::move(now);
  }
  return median(std::move(rates));
}

/// Measures the rate with moves that are adapted to a good size.
/// @return the rate; 0 if the platform stands still
double TurnMeter::measure_rate() {
  for (const double move_deg : first_moves_deg) {
    const double first = median_rate(few_moves, move_deg, around(0, widest_deg));
    if (std::abs(first * move_deg) < still_deg) {
      continue;
    }
    const double second =
        median_rate(few_moves, seen_move_deg / std::abs(first), around(0, widest_deg));
    const double sign = second > 0 ? 1 : -1;
    return second == 0 ? 0
                       : median_rate(more_moves, seen_move_deg / std::abs(second),
                                     around(sign * seen_move_deg, expected_deg));
  }
  return 0;
}

/// Moves by a whole turn and `apart_deg`, and corrects the rate by the angle measured to the first
/// frame. @return the rate over that whole turn
double TurnMeter::measure_whole(double rate) {
  const double sign = rate > 0 ? 1 : -1;
  double range_deg = closing_deg;
  for (int count = 0; count < closing_looks; ++count) {
    const double commanded_deg = sign * (360 + apart_deg) / rate;
    const DepthFrame now = look_from_below(commanded_deg, rate);
    const double seen_deg = seen(first_look_, now, around(sign * apart_deg, range_deg));
    rate = (sign * 360 + seen_deg) / commanded_deg;
    if (std::abs(seen_deg - sign * apart_deg) < settled_deg) {
      break;
    }
    range_deg = expected_deg;
  }
  return rate;
}

/// Moves on and back some times, and measures the angle to a position a little further on before
/// and after. @return by how much a move back falls short, degrees: the median, as an inexact pose
/// causes errors of a degree now and then
double TurnMeter::measure_play(double rate) {
  const double there_deg = commanded_deg_;
  const double on_deg = apart_deg / std::abs(rate);
  const AngleRange range = around(0, approach_deg);
  std::vector<double> short_by;
  for (int round = 0; round < play_rounds; ++round) {
    const DepthFrame before = look_from_below(there_deg, rate);
    const DepthFrame further = look_at(there_deg + on_deg);
    move_to(there_deg + approach_deg / std::abs(rate));
    const DepthFrame after = look_at(there_deg);
    short_by.push_back(seen(before, further, range) - seen(after, further, range));
  }
  const double short_deg = median(std::move(short_by));
  return rate > 0 ? short_deg : -short_deg;
}

/// Commands the starting angle again. @return the platform's offset from it, degrees
double TurnMeter::measure_return(double rate) {
  const double on_deg = apart_deg / std::abs(rate);
  const DepthFrame now = look_from_below(on_deg, rate);
  const double off_deg =
      seen(first_look_, now, around(rate * on_deg, approach_deg)) - rate * on_deg;
  move_to(0);
  return off_deg;
}

TurnMeasurement TurnMeter::measure() {
  move_to(-approach_deg);
  first_look_ = look_at(0);
  const double rate = measure_rate();
  if (median(sharpness_) < min_sharpness) {
    throw_unseen("the object on the platform looks the same from all sides");
  }
  if (rate == 0) {
    return {};
  }
  const double whole_rate = measure_whole(rate);
  const double play_deg = measure_play(whole_rate);
  return {.turn_deg = 360 * whole_rate,
          .play_deg = std::max(play_deg, 0.0),
          .return_deg = measure_return(whole_rate),
          .swings_for_s = swings_for_s_};
}

}  // namespace

TurnMeasurement measure_turn(Rig& rig, const Eigen::Isometry3d& platform_from_sensor,
                             const Box& clip, const std::stop_token& stop,
                             const std::function<void(double done)>& on_progress) {
  const PlatformLook view{.intrinsics = rig.sensor().intrinsics(),
                          .platform_from_sensor = platform_from_sensor,
                          .clip = clip};
  return TurnMeter(rig, view, stop, on_progress).measure();
}

}  // namespace octurn
