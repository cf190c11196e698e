#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/scan_observer.hpp"

namespace octurn {

/// A coarse surface of a scan by laser line, for people to see while the platform turns. The
/// surface at a line ends at those of the stops beside it, so that it is a stop behind. No bit of
/// the model depends on it.
///
/// Its cost is bounded: at most 100 lines of each laser, and leaves of 2 mm. A stop does not wait
/// for it; what it has missed is added at the next one.
class LinePreview {
 public:
  static constexpr double leaf_size = 0.002;  ///< metres, or the model's if that is larger
  static constexpr int max_lines = 100;       ///< of each laser

  /// @param folder    of the scan; it lives longer, as the observer does
  /// @param options   of the model
  /// @param stops     of the whole scan
  LinePreview(const std::filesystem::path& folder, ReconstructOptions options, int stops,
              std::stop_token stop, const ScanObserver& observer);
  /// Waits for what is being added.
  ~LinePreview() = default;
  LinePreview(const LinePreview&) = delete;
  LinePreview& operator=(const LinePreview&) = delete;

  /// Begins to add what the stops so far show, unless it is at it still.
  void add(const Scan& scan);

  /// Returns when it is no more at it.
  void wait() const;

 private:
  void add_lines(const Scan& scan, std::size_t first, std::size_t end);

  const std::filesystem::path& folder_;
  std::size_t step_;  // from a stop whose line is added to the next
  std::stop_token stop_;
  const ScanObserver& observer_;
  ReconstructOptions options_;
  std::unique_ptr<Reconstructor> reconstruction_ = {};  // once there is something to add
  std::atomic<bool> has_failed_ = false;
  std::size_t next_ = 1;           // in steps: the line to be added
  std::future<void> adding_ = {};  // the last member: it ends before what it uses
};

}  // namespace octurn
