#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "octurn/box.hpp"
#include "octurn/depth_filter.hpp"
#include "octurn/reconstruct.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {

/// One for each processor.
int available_threads();

/// Half of the machine's memory, bytes: the rest is for the system and its buffers.
std::size_t half_of_memory();

/// What one scan is made with.
struct ScanSettings {
  int snapshots = 36;  ///< stops in a turn
  DepthFilter filter = DepthFilter::average;
  int frames = 10;  ///< at each stop, for the filters that merge
  Method method = Method::solid;
  double leaf_size = 0.001;   ///< metres
  double threshold = 0.0001;  ///< square metres, of a triangle's longest side; intersection
  double target_error = ReconstructOptions{}.target_error;  ///< metres; solid
  double root_size = 1.0;                                   ///< metres
  /// Metres, platform frame. Below 5 mm lies what a Kinect v1 sees of the platform, with its noise.
  Box clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}};
  Eigen::Isometry3d platform_from_sensor = nominal_platform_from_sensor();
};

/// What a reconstruction may use of this machine. No byte of a model depends on it.
struct Limits {
  int threads = available_threads();
  std::size_t memory_bytes = half_of_memory();  ///< for the whole process; 0 is no limit
};

/// The settings of the reconstruction among them.
ReconstructOptions reconstruct_options(const ScanSettings& settings, const Limits& limits);

/// As the API and the files have them: lengths in millimetres, each key with its unit.
nlohmann::json json_of(const ScanSettings& settings);

/// Reads settings; a key that is not given is as in `defaults`.
///
/// @param name  of the object in messages; empty for the outermost
/// @throws Error "bad-settings"  that names the key, its value and what is allowed; also for a key
///                               that is none
ScanSettings settings_from(const nlohmann::json& object, const ScanSettings& defaults,
                           const std::string& name = "");

}  // namespace octurn
