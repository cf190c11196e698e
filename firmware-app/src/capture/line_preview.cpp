#include "capture/line_preview.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

// `SolidOptions::truncation` is at least 2.5 voxels.
constexpr double truncation_leaves = 2.5;

ReconstructOptions coarse(ReconstructOptions options) {
  options.leaf_size = std::max(options.leaf_size, LinePreview::leaf_size);
  options.solid.truncation =
      std::max(options.solid.truncation, truncation_leaves * options.leaf_size);
  options.threads = 1;
  options.memory_limit = 0;  // little is used, and the model's is free until the turn ends
  return options;
}

constexpr double min_coverage = 0.6;  // of the readings at the first stop

}  // namespace

LinePreview::LinePreview(const std::filesystem::path& folder, ReconstructOptions options, int stops,
                         std::stop_token stop, const ScanObserver& observer)
    : folder_(folder),
      step_(static_cast<std::size_t>((stops + max_lines - 1) / max_lines)),
      stop_(std::move(stop)),
      observer_(observer),
      options_(coarse(std::move(options))) {}

void LinePreview::add(const Scan& scan) {
  using namespace std::chrono_literals;
  const bool is_adding = adding_.valid() && adding_.wait_for(0s) != std::future_status::ready;
  const std::size_t end = scan.shots.empty() ? 0 : (scan.shots.size() - 1) / step_;
  if (is_adding || has_failed_ || next_ >= end) {
    return;
  }
  adding_ = std::async(std::launch::async, [this, scan, first = next_, end] {
    try {
      add_lines(scan, first, end);
    } catch (const Stopped&) {
    } catch (const Error& error) {  // a picture is unreadable: the model leaves it out, too
      log::warning("scan", std::string("no preview: ") + error.what());
      has_failed_ = true;
    }
  });
  next_ = end;
}

void LinePreview::wait() const {
  if (adding_.valid()) {
    adding_.wait();
  }
}

/// Adds each line with its neighbours a step before and after it, where its surface ends.
void LinePreview::add_lines(const Scan& scan, std::size_t first, std::size_t end) {
  if (!reconstruction_) {
    reconstruction_ = make_reconstructor(options_);
  }
  Scan three = scan;
  for (std::size_t line = first; line < end; ++line) {
    three.shots = {scan.shots[(line - 1) * step_], scan.shots[line * step_],
                   scan.shots[(line + 1) * step_]};
    reconstruction_->add(stored_snapshots(folder_, three, stop_).read(1), stop_);
  }
  observer_.on_added(*reconstruction_, static_cast<int>(scan.shots.size()));
}

std::ptrdiff_t readings_in(const DepthFrame& frame) {
  return std::ranges::count_if(frame.depth, [](std::uint16_t depth) { return depth > 0; });
}

void expect_coverage(std::ptrdiff_t readings, std::ptrdiff_t first, const std::string& sensor) {
  if (readings == 0 || static_cast<double>(readings) < min_coverage * static_cast<double>(first)) {
    throw Error(ErrorCode::sensor_blind,
                sensor + ": has " + std::to_string(readings) +
                    " readings in its picture, and had " + std::to_string(first) +
                    " at the first stop",
                "Look for something before its lenses, and for sunlight.");
  }
}

}  // namespace octurn
