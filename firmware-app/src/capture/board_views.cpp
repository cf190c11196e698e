#include "capture/board_views.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "octurn/error.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int wanted_depth_views = 24;  // dots blur corners: twice those of a camera
constexpr int depth_frames = 10;        // more frames hardly lower the noise
constexpr int patience = 8;  // pictures of one hold that give no view, by a simulated person

/// Shows a board to a simulated sensor during its lifetime.
class HeldBoard {
 public:
  explicit HeldBoard(DepthSensor& sensor) : sensor_(sensor) { next(); }
  ~HeldBoard() {
    try {
      sensor_.show_board(0);
    } catch (const Error&) {  // a sensor that is gone shows no board
    }
  }
  HeldBoard(const HeldBoard&) = delete;
  HeldBoard& operator=(const HeldBoard&) = delete;

  /// Has it held another way after a view, or when it has given none for a while.
  void seen(bool is_view) {
    if (is_view || ++pictures_ >= patience) {
      next();
    }
  }

 private:
  void next() {
    pictures_ = 0;
    sensor_.show_board(++hold_);
  }

  DepthSensor& sensor_;
  int hold_ = 0;
  int pictures_ = 0;
};

/// The mean of frames that are taken from now on. @return nothing if stopped first
std::optional<DepthFrame> mean_depth(DepthSensor& sensor, const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<DepthFrame> frames;
  while (frames.size() < depth_frames) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return std::nullopt;
    }
    if (timed->time > begin) {
      frames.push_back(std::move(timed->frame));
    }
  }
  return merge_frames(frames, DepthFilter::average);
}

/// A picture that is taken from now on: the first one may still be from before the depth frames.
std::optional<Picture> new_picture(DepthSensor& sensor, const std::stop_token& stop) {
  return sensor.read_infrared(stop) ? sensor.read_infrared(stop) : std::nullopt;
}

}  // namespace

std::vector<DepthBoardView> take_board_views(
    DepthSensor& sensor, const std::stop_token& stop,
    const std::function<void(const Picture& picture, const BoardLook& look)>& on_picture) {
  HeldBoard board(sensor);
  BoardWatch watch(sensor.intrinsics(), find_dotted_board, wanted_depth_views);
  std::vector<DepthBoardView> views;
  while (!watch.is_complete()) {
    const std::optional<Picture> picture = sensor.read_infrared(stop);
    if (!picture) {
      break;
    }
    const bool is_view = watch.see(*picture);
    if (is_view) {
      const std::optional<DepthFrame> depth = mean_depth(sensor, stop);
      const std::optional<Picture> after = depth ? new_picture(sensor, stop) : std::nullopt;
      if (after && watch.shows_last_view(*after)) {
        const BoardView& corners = watch.views().back();
        views.push_back(
            {.corners = corners, .depths = board_depths(corners, *depth, sensor.intrinsics())});
      } else {
        watch.drop_last_view();
      }
    }
    board.seen(is_view);
    on_picture(*picture, watch.look());
  }
  return views;
}

}  // namespace octurn
