#include "store/scan_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "octurn/median.hpp"
#include "store/data_folder.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_similar_scans = 5;  // number of most similar earlier scans

// Defaults before the first scan: a Kinect's frame rate; the others are a simulated rig's.
constexpr double rate_hz = 30;
constexpr Seconds unmeasured_stop{0.5};  // to settle, and to store the snapshot
constexpr Seconds unmeasured_model{1.0};
constexpr Seconds unmeasured_snapshot{0.15};  // read twice, as the pose is usually corrected
constexpr double unmeasured_leaf = 0.001;     // metres
constexpr double unmeasured_snapshot_bytes = 250'000;  // a Kinect's depth image, as PNG
constexpr double unmeasured_model_bytes = 1'500'000;   // with leaves of that size

int depth_frames(const ScanSettings& settings) {
  return settings.filter == DepthFilter::basic ? 1 : settings.frames;
}

/// Duration of the turn to the next stop at the default speeds of StepperSettings: a move of up to
/// 115 degrees gains speed for half of the way, and brakes for the other half.
Seconds unmeasured_turn(int snapshots) {
  constexpr double start = 18;           // degrees per second
  constexpr double acceleration = 67.5;  // degrees per second squared
  const double top = std::sqrt(start * start + acceleration * 360 / snapshots);
  return Seconds{2 * (top - start) / acceleration};
}

/// Ratio of a model's build time, or bytes, between two leaf sizes.
double growth(double leaf, double measured_leaf) {
  return (measured_leaf / leaf) * (measured_leaf / leaf);
}

/// Returns the scans with the minimum `dissimilarity`, newest first, at most `max_similar_scans`.
/// @param dissimilarity  of a scan to the one to estimate; 0 if they are alike
template <typename Dissimilarity>
std::vector<const EarlierScan*> most_similar(const std::vector<const EarlierScan*>& scans,
                                             Dissimilarity dissimilarity) {
  std::vector<const EarlierScan*> similar;
  for (const EarlierScan* const scan : scans) {
    const double difference =
        similar.empty() ? 0 : dissimilarity(*scan) - dissimilarity(*similar.front());
    if (difference < 0) {
      similar.clear();
    }
    if (difference <= 0 && similar.size() < max_similar_scans) {
      similar.push_back(scan);
    }
  }
  return similar;
}

template <typename Fits>
std::vector<const EarlierScan*> matching(const std::vector<EarlierScan>& scans, Fits fits) {
  std::vector<const EarlierScan*> found;
  for (const EarlierScan& scan : scans) {
    if (scan.job.state == JobState::finished && scan.job.model && scan.job.settings.snapshots > 0 &&
        !scan.job.pose_of && fits(scan.job.settings)) {
      found.push_back(&scan);
    }
  }
  return found;
}

template <typename Value>
Seconds median_value(const std::vector<const EarlierScan*>& scans, Value value) {
  std::vector<double> values;
  values.reserve(scans.size());
  for (const EarlierScan* const scan : scans) {
    values.push_back(Seconds(value(*scan)).count());
  }
  return Seconds(median(std::move(values)));
}

}  // namespace

ScanEstimate estimate_scan(const std::vector<EarlierScan>& earlier, const ScanSettings& settings) {
  const int snapshots = settings.snapshots;
  const auto stops = most_similar(
      matching(earlier,
               [&](const ScanSettings& other) {
                 return other.filter == settings.filter &&
                        depth_frames(other) == depth_frames(settings);
               }),
      [&](const EarlierScan& scan) {
        return std::abs(std::log(static_cast<double>(scan.job.settings.snapshots) / snapshots));
      });
  const auto models = most_similar(
      matching(earlier, [&](const ScanSettings& other) { return other.method == settings.method; }),
      [&](const EarlierScan& scan) {
        return std::abs(std::log(scan.job.settings.leaf_size / settings.leaf_size));
      });
  const double unmeasured_growth = growth(settings.leaf_size, unmeasured_leaf);
  ScanEstimate estimate{
      .stop =
          unmeasured_turn(snapshots) + unmeasured_stop + Seconds(depth_frames(settings) / rate_hz),
      .build = unmeasured_growth * unmeasured_model + snapshots * unmeasured_snapshot,
      .is_measured = !stops.empty() && !models.empty()};
  double bytes = snapshots * unmeasured_snapshot_bytes + unmeasured_growth * unmeasured_model_bytes;
  if (!stops.empty()) {
    estimate.stop = median_value(stops, [](const EarlierScan& scan) {
      const Job& job = scan.job;
      return (job.times.elapsed - job.model->build_time) / (job.settings.snapshots + 1);
    });
  }
  if (!models.empty()) {
    estimate.build = median_value(models, [&](const EarlierScan& scan) {
      const ScanSettings& other = scan.job.settings;
      return scan.job.model->build_time * growth(settings.leaf_size, other.leaf_size) * snapshots /
             other.snapshots;
    });
    const EarlierScan& last = *models.front();
    const ScanSettings& other = last.job.settings;
    bytes = static_cast<double>(last.snapshot_bytes) * snapshots / other.snapshots +
            static_cast<double>(last.job.model->report.bytes) *
                growth(settings.leaf_size, other.leaf_size);
  }
  estimate.bytes = static_cast<std::uint64_t>(bytes);
  return estimate;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_earlier_scans = 20;

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const std::string& name : names_in(folder)) {
    std::error_code gone;
    const std::uintmax_t size = fs::file_size(folder / name, gone);
    bytes += gone ? 0 : size;
  }
  return bytes;
}

}  // namespace

std::vector<EarlierScan> earlier_scans(const ScanStore& store) {
  std::vector<EarlierScan> scans;
  for (Job& job : store.list()) {
    if (job.state == JobState::finished && scans.size() < max_earlier_scans) {
      const std::uint64_t bytes = bytes_in(store.folder(job.id) / "snapshots");
      scans.push_back({.job = std::move(job), .snapshot_bytes = bytes});
    }
  }
  return scans;
}

}  // namespace octurn
