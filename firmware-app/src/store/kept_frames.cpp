#include "store/kept_frames.hpp"

#include <algorithm>
#include <utility>

namespace octurn {
namespace {

bool any(std::uint16_t depth) { return depth != 0; }

auto find_row(const DepthFrame& frame, int v) {
  return frame.depth.begin() + static_cast<std::ptrdiff_t>(v) * frame.width;
}

}  // namespace

KeptFrames::KeptFrames(std::size_t count, std::size_t max_bytes)
    : windows_(count), room_(max_bytes) {}

void KeptFrames::keep(std::size_t index, const DepthFrame& frame) {
  int left = frame.width;
  int right = 0;
  int top = frame.height;
  int bottom = 0;
  for (int v = 0; v < frame.height; ++v) {
    const auto begin = find_row(frame, v);
    const auto end = begin + frame.width;
    const auto first = std::find_if(begin, end, any);
    if (first != end) {
      const auto last = std::find_if(std::reverse_iterator(end), std::reverse_iterator(begin), any);
      left = std::min(left, static_cast<int>(first - begin));
      right = std::max(right, static_cast<int>(last.base() - begin));
      top = std::min(top, v);
      bottom = v + 1;
    }
  }
  Window window{.width = frame.width, .height = frame.height};
  if (bottom > 0) {
    window.left = left;
    window.top = top;
    window.columns = right - left;
  }
  const std::size_t bytes = sizeof(std::uint16_t) * static_cast<std::size_t>(window.columns) *
                            static_cast<std::size_t>(std::max(bottom - window.top, 0));
  std::size_t room = room_;
  do {
    if (room < bytes) {
      return;
    }
  } while (!room_.compare_exchange_weak(room, room - bytes));
  window.depth.reserve(bytes / sizeof(std::uint16_t));
  for (int v = window.top; v < bottom; ++v) {
    const auto from = find_row(frame, v) + window.left;
    window.depth.insert(window.depth.end(), from, from + window.columns);
  }
  windows_[index] = std::move(window);
}

std::optional<DepthFrame> KeptFrames::find(std::size_t index) const {
  const auto& window = windows_[index];
  if (!window) {
    return std::nullopt;
  }
  DepthFrame frame{.width = window->width, .height = window->height, .depth = {}};
  frame.depth.resize(static_cast<std::size_t>(frame.width) *
                     static_cast<std::size_t>(frame.height));
  auto to =
      frame.depth.begin() + static_cast<std::ptrdiff_t>(window->top) * frame.width + window->left;
  for (auto from = window->depth.begin(); from != window->depth.end();
       from += window->columns, to += frame.width) {
    std::copy_n(from, window->columns, to);
  }
  return frame;
}

}  // namespace octurn
