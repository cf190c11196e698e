#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <stop_token>
#include <string>

#include "capture/scan_observer.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A coarse surface of a scan by laser line, shown while the platform turns. A line's surface ends
/// at the lines of the neighbouring stops, so that the preview is one stop behind. The model does
/// not depend on it.
///
/// Its cost is bounded: at most 100 lines of each laser, and leaves of 2 mm. No stop waits for it;
/// a stop that comes while lines are being added is added with the next one.
class LinePreview {
 public:
  static constexpr double leaf_size = 0.002;  ///< metres, or the model's if that is larger
  static constexpr int max_lines = 100;       ///< of each laser

  /// @param folder    of the scan; it and the observer must outlive this
  /// @param options   of the model
  /// @param stops     of the whole scan
  LinePreview(const std::filesystem::path& folder, ReconstructOptions options, int stops,
              std::stop_token stop, const ScanObserver& observer);
  /// Waits as `wait` does.
  ~LinePreview() = default;
  LinePreview(const LinePreview&) = delete;
  LinePreview& operator=(const LinePreview&) = delete;

  /// Starts to add the stops so far, unless earlier ones are still being added.
  void add(const Scan& scan);

  /// Waits until nothing is being added.
  void wait() const;

 private:
  void add_lines(const Scan& scan, std::size_t first, std::size_t end);

  const std::filesystem::path& folder_;
  std::size_t step_;  // stops between two added lines
  std::stop_token stop_;
  const ScanObserver& observer_;
  ReconstructOptions options_;
  std::unique_ptr<Reconstructor> reconstruction_ = {};  // created with the first line
  std::atomic<bool> has_failed_ = false;
  std::size_t next_ = 1;           // index of the next line to add, in steps
  std::future<void> adding_ = {};  // the last member: it ends before what it uses
};

/// Returns the number of pixels with a depth.
std::ptrdiff_t readings_in(const DepthFrame& frame);

/// Checks that a stop has about as many readings as the first one: only a part of the picture
/// turns.
/// @param readings  at this stop
/// @param first     at the scan's first stop
/// @param sensor    name, for the message
/// @throws Error "sensor-blind"  if there are none, or far fewer than at the first stop
void expect_coverage(std::ptrdiff_t readings, std::ptrdiff_t first, const std::string& sensor);

}  // namespace octurn
