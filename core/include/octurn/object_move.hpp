#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/depth_frame.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// How an object stands in one more look than it stood in an earlier one from the same angle.
struct ObjectMove {
  double shift = 0;        ///< metres along the platform, of the middle of what is seen of it
  double shift_sigma = 0;  ///< metres, in the direction of the shift
  double turn = 0;         ///< radians about that middle, counter-clockwise seen from above
  double turn_sigma = 0;   ///< radians; large for an object that looks the same from all sides
};

/// A shift that is too large to be measured, metres: an object that is not found again has this.
inline constexpr double max_measured_shift = 0.02;

/// Measures how an object moved from one look to another.
///
/// Both see the platform at the same angle, so all of the sensor's fixed errors are the same in
/// both. A reading p of the first, moved by R(turn) (p - m) + m + shift, must lie on the surface
/// that the second saw: point-to-plane distances, minimised by Gauss-Newton over the shift along
/// the platform and the turn about its normal, m the middle of the readings (Chen and Medioni
/// 1992).
///
/// @param first  with the pose that tells the platform's surface and axis
/// @param again  a depth image by the same sensor from the same place
/// @param clip   metres, object's frame: around the object
/// @return nothing if the first look saw too little of an object
/// @throws std::invalid_argument  if a frame's size is not that of the intrinsics
std::optional<ObjectMove> measure_move(const Snapshot& first, const DepthFrame& again,
                                       const Box& clip);

/// Adds the finding "moved" of such a look after a turn, if the object moved by more than 1 mm or
/// 0.6 degrees, and three sigma. A move, a slip or a turn that is not whole, which the turn's own
/// findings tell of, explains it, and is not told twice.
void add_move(std::vector<CalibrationFinding>& findings, const ObjectMove& move);

/// Writes how the object had moved at the last look into `folder/scan.json`, as its `last_look`,
/// whole or not at all. All its other keys stay.
/// @throws Error  as `read_scan` and `write_scan`
void write_object_move(const std::filesystem::path& folder, const ObjectMove& move);

/// What scan.json keeps of the last look.
/// @return nothing if there was none
/// @throws Error "scan-missing", "scan-malformed"
std::optional<ObjectMove> read_object_move(const std::filesystem::path& folder);

}  // namespace octurn
