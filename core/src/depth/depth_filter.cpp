#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr std::array<std::pair<DepthFilter, std::string_view>, 3> names{{
    {DepthFilter::basic, "basic"},
    {DepthFilter::average, "average"},
    {DepthFilter::average_discard, "average-discard"},
}};

}  // namespace

std::string_view to_string(DepthFilter filter) {
  return std::ranges::find(names, filter, &std::pair<DepthFilter, std::string_view>::first)->second;
}

std::optional<DepthFilter> depth_filter_named(std::string_view name) {
  const auto* found =
      std::ranges::find(names, name, &std::pair<DepthFilter, std::string_view>::second);
  return found == names.end() ? std::nullopt : std::optional(found->first);
}

DepthFrame merge_frames(std::span<const DepthFrame> frames, DepthFilter filter) {
  if (frames.empty()) {
    throw std::invalid_argument("merge_frames: no frames");
  }
  const DepthFrame& first = frames.front();
  for (const DepthFrame& frame : frames) {
    if (frame.width != first.width || frame.height != first.height ||
        frame.depth.size() != first.depth.size()) {
      throw std::invalid_argument("merge_frames: frames of different sizes");
    }
  }
  if (filter == DepthFilter::basic) {
    return first;
  }

  const std::size_t min_valid = filter == DepthFilter::average_discard ? frames.size() : 1;
  DepthFrame merged{.width = first.width, .height = first.height, .depth = {}};
  merged.depth.resize(first.depth.size());
  for (std::size_t i = 0; i < merged.depth.size(); ++i) {
    std::size_t sum = 0;
    std::size_t valid = 0;
    for (const DepthFrame& frame : frames) {
      sum += frame.depth[i];
      valid += frame.depth[i] != 0 ? 1U : 0U;
    }
    if (valid >= min_valid) {
      merged.depth[i] = static_cast<std::uint16_t>((sum + valid / 2) / valid);
    }
  }
  return merged;
}

}  // namespace octurn
