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
#include "octurn/mesh_report.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Whether a model shows its object.
enum class Verdict {
  good,  ///< as far as the depth images tell
  look,  ///< but for what its reasons say
  bad,   ///< not
};

/// The verdict's name in reports: "good", "look", "bad".
std::string_view to_string(Verdict verdict);

/// Why a model is not good.
struct QualityReason {
  /// "empty", "stops-disagree", "moved", "floats", "sunk", "little-seen", "cut-by-box",
  /// "parts-dropped", "part-missing"
  std::string code = {};
  std::string detail = {};     ///< what was found and its size, for people
  std::string hint = {};       ///< what to do about it
  Parameters parameters = {};  ///< the values in `detail`; their names tell what it says
  /// Metres, model's frame: where that is, at most `Places::max_count`; none if it is everywhere.
  std::vector<Eigen::Vector3d> places = {};

  bool operator==(const QualityReason&) const = default;
};

struct Quality {
  Verdict verdict = Verdict::good;
  std::vector<QualityReason> reasons = {};  ///< in the order of `QualityReason::code`; none if good

  bool operator==(const Quality&) const = default;
};

/// What the depth images of a scan say about the pose and the box that a model is made with.
struct ScanFigures {
  std::size_t stops = 0;
  double object_pixels = 0;  ///< readings inside the box that a stop has, on average
  double distance = 0;       ///< metres, of these readings from the sensor, on average
  double widest_gap = 0;     ///< radians, the largest turn from one stop to the next
  /// Pixels of a depth image, on average, at which the box cuts through a surface: at its sides
  /// towards -x, +x, -y, +y, and at its top.
  std::array<double, 5> cut_pixels = {};
  std::array<std::vector<Eigen::Vector3d>, 5> cut_places = {};  ///< metres, object's frame
  /// Metres: how high the platform's surface is seen above z = 0; nothing if it is not seen.
  std::optional<double> platform_height = {};
  double disagreement = 0;  ///< metres: median distance between what two stops saw of the object
  std::vector<Eigen::Vector3d> disagreeing_places =
      {};  ///< metres: where it is far more than noise
  /// Of each stop: the share of what it saw of the object that is empty space as others saw it.
  std::vector<double> contradicted = {};
  /// Metres: where that is, at the stop with the largest share.
  std::vector<Eigen::Vector3d> contradicted_places = {};
  /// Metres, object's frame: where several stops saw the object, coarsely.
  std::vector<Eigen::Vector3d> seen = {};
};

/// Checks the depth images of a scan while they are read for its model.
class ScanCheck {
 public:
  /// @param clip   metres, object's frame: the box that the model is clipped to
  /// @param stops  of the scan
  ScanCheck(const Box& clip, std::size_t stops);
  ~ScanCheck();
  ScanCheck(const ScanCheck&) = delete;
  ScanCheck& operator=(const ScanCheck&) = delete;

  /// Adds a snapshot with the pose that the model is made with, in place of one of the same index.
  /// Keeps some 100 kB of it. Called by several threads at once for different stops, in any order.
  /// @param stop  below the number of stops
  /// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
  void add(std::size_t stop, const Snapshot& snapshot);

  /// Compares the stops that were added. The same for any number of threads.
  ScanFigures figures(int threads = 1) const;

  /// One stop, as far as it is needed.
  struct Stop;

 private:
  Box clip_;
  std::vector<std::unique_ptr<Stop>> stops_;
};

/// Judges a finished model.
/// @param model     its figures
/// @param findings  of the calibration from the same depth images, if there was one
Quality judge(const ScanFigures& scan, const ModelReport& model,
              std::span<const CalibrationFinding> findings = {});

/// Judges a finished model of several poses.
/// @param poses     what the depth images of each say, places in the object's frame; at least one
/// @param findings  of the first one's calibration
Quality judge(std::span<const ScanFigures> poses, const ModelReport& model,
              std::span<const CalibrationFinding> findings = {});

}  // namespace octurn
