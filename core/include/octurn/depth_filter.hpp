#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "octurn/depth_frame.hpp"

namespace octurn {

/// How the frames of one still scene become one depth image (Bennett 2014, the three filters).
enum class DepthFilter {
  basic,            ///< the first frame, unchanged
  average,          ///< at each pixel the mean of the valid readings
  average_discard,  ///< the same, but a pixel without a reading in any frame has none
};

/// The filter's name in settings and files: "basic", "average", "average-discard".
std::string_view name_of(DepthFilter filter);

/// The filter of that name, if there is one.
std::optional<DepthFilter> depth_filter_named(std::string_view name);

/// Merges frames of one still scene into one depth image. Means are rounded to the nearest depth
/// unit, halves up.
///
/// @param frames  at least one, all of one size
/// @throws std::invalid_argument  if there is no frame, or the frames' sizes differ
DepthFrame merge_frames(std::span<const DepthFrame> frames, DepthFilter filter);

}  // namespace octurn
