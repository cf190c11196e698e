#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Whether a model is a faithful copy of its object.
enum class Verdict {
  good,  ///< the depth images show no fault
  look,  ///< usable, with faults that a person should look at
  bad,   ///< unusable
};

/// The verdict's name in reports, "good", "look", "bad".
std::string_view to_string(Verdict verdict);

/// Why a model is not good.
struct QualityReason {
  /// "empty", "too-low", "lasers-exchanged", "turntable", "alike", "stops-disagree", "moved",
  /// "focal-length", "optics", "floats", "sunk", "top-unseen", "little-seen", "filled-far",
  /// "hollow-filled", "cut-by-box", "parts-dropped", "part-missing", "swollen", "large-file",
  /// "warm-up"
  std::string code = {};
  std::string detail = {};     ///< what was found and its size, for people
  std::string hint = {};       ///< what to do about it
  Parameters parameters = {};  ///< the values in `detail`, for translations
  /// Metres, object's frame: where the fault is, at most 300 points; empty if it has no place.
  std::vector<Eigen::Vector3d> places = {};

  bool operator==(const QualityReason&) const = default;
};

/// By how much a length of a model may differ from the object's: two standard deviations.
struct SizeError {
  double length = 0;  ///< metres: the longest side of the model's bounding box
  double error = 0;   ///< metres

  bool operator==(const SizeError&) const = default;
};

/// The verdict on a model, and why.
struct Quality {
  Verdict verdict = Verdict::good;
  /// Causes first; what follows from a cause is left out. Of a good model only
  /// "hollow-filled" and "warm-up".
  std::vector<QualityReason> reasons = {};
  std::optional<SizeError> size_error = {};

  bool operator==(const Quality&) const = default;
};

/// What stops see between the platform's noise and the clip box.
struct BelowBox {
  double noise_end = 0;  ///< metres above z = 0: end of the platform's noise
  double pixels = 0;     ///< mean number at a stop between there and the box's bottom

  /// Metres above z = 0: where the box could begin. A model merges the readings of many stops, so
  /// its noise ends at less than half of their height.
  double possible_bottom() const { return noise_end / 2; }

  /// Whether most of an object lies there. @param inside  mean number at a stop inside the box
  bool has_most(double inside) const;
};

/// Where stops differ: metres, object's frame.
struct DifferingPlaces {
  /// Surfaces whose distance is far larger than noise.
  std::vector<Eigen::Vector3d> disagreeing = {};
  /// Readings in free space, at the stop that has most of them.
  std::vector<Eigen::Vector3d> contradicted = {};
};

/// How a hollow shell of leaves lies on the surface that the stops saw.
struct ShellFigures {
  double swelling = 0;     ///< metres: by which its outside is further out
  double stray_share = 0;  ///< of the leaves: where stops saw free space, and none a surface
};

/// Measurements on the depth images of a scan, with the poses and the clip box of its model.
struct ScanFigures {
  SensorTraits sensor = {};
  std::size_t stops = 0;
  double object_pixels = 0;  ///< mean number of readings inside the box at a stop
  double distance = 0;       ///< metres: mean distance of these readings from the sensor
  double widest_gap = 0;     ///< radians: largest angle between neighbouring stops
  /// Mean number of pixels at a stop where the box cuts through a surface: at its sides towards -x,
  /// +x, -y, +y, and at its top.
  std::array<double, 5> cut_pixels = {};
  std::array<std::vector<Eigen::Vector3d>, 5> cut_places = {};  ///< metres, object's frame
  /// Metres: measured z of the platform's surface; nothing if it is not seen.
  std::optional<double> platform_height = {};
  double disagreement = 0;  ///< metres: median distance between the surfaces that two stops saw
  /// For each stop: the share of its readings of the object that other stops see to be free space.
  std::vector<double> contradicted = {};
  DifferingPlaces differing = {};
  /// Metres, object's frame: centres of 5 mm cells in which several stops saw the object.
  std::vector<Eigen::Vector3d> seen = {};
  BelowBox below = {};
  /// Metres above the highest reading of the object: end of a hole in the readings, at most stops.
  double unseen_top = 0;
  ShellFigures shell = {};

  /// How much larger the sensor's noise is than at `noise_distance`: it grows with the distance's
  /// square.
  double noise_growth() const;
};

/// Measures the depth images of a scan while they are read for its model.
class ScanCheck {
 public:
  /// @param clip   metres, object's frame: the box that the model is clipped to
  /// @param stops  number of stops of the scan
  ScanCheck(const Box& clip, std::size_t stops, const SensorTraits& sensor = {});
  ~ScanCheck();
  ScanCheck(const ScanCheck&) = delete;
  ScanCheck& operator=(const ScanCheck&) = delete;

  /// Adds a snapshot with the model's pose; replaces an earlier one of the same stop. Keeps about
  /// 100 kB of it. May be called by several threads at once for different stops, in any order.
  /// @param stop  index, below the number of stops
  /// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
  void add(std::size_t stop, const Snapshot& snapshot);

  /// Compares the stops that were added. Deterministic for any number of threads.
  /// @param leaves  metres, object's frame: as `ModelPlaces::leaves`, to compare with the stops
  ScanFigures figures(int threads = 1, std::span<const Eigen::Vector3d> leaves = {}) const;

  /// Metres: where the box could begin, if most of what stands on the platform is below it.
  std::optional<double> lower_bottom() const;

  /// The samples that are kept of one stop.
  struct Stop;

 private:
  std::vector<const Stop*> added() const;

  Box clip_;
  SensorTraits sensor_;
  std::vector<std::unique_ptr<Stop>> stops_;
};

/// The same for a scan of several poses, each with its own platform frame and clip box.
class PoseChecks {
 public:
  /// @param placements  one for each pose; empty: one pose with the clip box `clip`
  /// @param stops       number of stops, of all poses together
  PoseChecks(std::vector<Placement> placements, const Box& clip, std::size_t stops,
             const SensorTraits& sensor);

  /// Adds a stop's snapshot. Threads and errors are as of `ScanCheck::add`.
  /// @param stop  index, below the number of stops
  void add(std::size_t stop, const Snapshot& snapshot);

  /// Returns the figures of each pose, with places in the object's frame.
  /// @param leaves  as in `ScanCheck::figures`; compared with the first pose
  std::vector<ScanFigures> figures(int threads, std::span<const Eigen::Vector3d> leaves) const;

  /// As `ScanCheck::lower_bottom`; nothing for several poses.
  std::optional<double> lower_bottom() const;

 private:
  std::vector<Placement> placements_;
  std::vector<std::unique_ptr<ScanCheck>> checks_;
};

/// Throws an error with this cause in place of "model-empty", if the object is below the clip box.
/// @param error  of the model of the snapshots that were added
void expect_higher_object(const Error& error, const PoseChecks& checks);

/// Wraps a source: each snapshot that is read is also added to `checks`, which must outlive it.
SnapshotSource checked_snapshots(SnapshotSource snapshots, PoseChecks& checks);

/// The expected size error of a model, from the sigmas of focal length and scale.
/// @param size  of the model's bounding box, metres
/// @param seen  what the scan's calibration found of the optics, applied or not
/// @return nothing for a scan by laser line or with free poses
std::optional<SizeError> expected_size_error(const Scan& scan, const Eigen::Vector3d& size,
                                             const std::optional<SolvedOptics>& seen = {});

/// Adds the reason "warm-up" to a verdict, which stays: the sensor's map was made when the sensor
/// had been on for another time than in the scan, by more than five minutes. What lies beyond half
/// an hour counts as half an hour.
void add_warm_up(Quality& quality, const Scan& scan);

/// Judges a finished model.
/// @param model     its figures
/// @param findings  of the calibration from the same depth images, if there was one
Quality judge(const ScanFigures& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings = {});

/// Judges a finished model of several poses.
/// @param poses     the figures of each pose, places in the object's frame; at least one
/// @param findings  of the calibration from the first pose's depth images
Quality judge(std::span<const ScanFigures> poses, const ModelReport& model,
              std::span<const CalibrationFinding> findings = {});

/// Judges a finished model of a scan: as above, with the expected size error and "warm-up".
/// @param checks    of the snapshots that the model was made of
/// @param scan      with the pose that it was made with
/// @param findings  of the calibration from the same depth images, and of the object's move
/// @param seen      as in `expected_size_error`
Quality judge(const PoseChecks& checks, int threads, const Scan& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings,
              const std::optional<SolvedOptics>& seen);

}  // namespace octurn
