#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "octurn/json_object.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/snapshot.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {

/// One for each processor.
int available_threads();

/// Half of the machine's memory, bytes, in whole MB: the rest is for the system and its buffers.
std::size_t half_of_memory();

/// Which pose of the sensor a model is made with.
enum class PoseSource {
  solved,  ///< the scan's solved pose, else one solved from its snapshots, if that is better
  told,    ///< what the rig was told
};

/// The source's name in settings: "auto", "told".
std::string_view to_string(PoseSource source);

/// Range of the factor of a sensor's depths: one that is farther off has another fault.
inline constexpr double min_depth_scale = 0.97;
inline constexpr double max_depth_scale = 1.03;

/// What one scan is made with.
struct ScanSettings {
  int snapshots = 36;  ///< stops in a turn
  DepthFilter filter = DepthFilter::average;
  int frames = 10;  ///< at each stop, for the filters that merge
  Method method = Method::solid;
  double leaf_size = 0.001;   ///< metres
  double threshold = 0.0001;  ///< square metres, of a triangle's longest side; intersection
  double target_error = ReconstructOptions{}.target_error;  ///< metres; solid
  Parts parts = Parts::main;                                ///< solid
  double root_size = 1.0;                                   ///< metres
  /// Metres, platform frame. Below 5 mm lies what a Kinect v1 sees of the platform, with its noise.
  Box clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}};
  PoseSource pose = PoseSource::solved;
  /// As the rig is told: optical frame to platform frame, metres.
  Eigen::Isometry3d platform_from_sensor = nominal_platform_from_sensor();
  double depth_scale = 1;  ///< factor of the sensor's depths
};

/// What a reconstruction may use of this machine. No byte of a model depends on it.
struct Limits {
  int threads = available_threads();
  std::size_t memory_bytes = half_of_memory();  ///< for the whole process; 0 is no limit
};

/// What `octurn reconstruct` makes a model with.
struct ModelSettings {
  ScanSettings scan = {.method = Method::intersection};
  std::optional<int> level = {};  ///< surface of this coarser level; intersection
  Limits limits = {.memory_bytes = 0};
};

struct Field;

/// Every setting of a scan, with its key, unit and range.
std::vector<Field> fields(ScanSettings& settings);
/// Those of `octurn scan`: all but where the sensor stands.
std::vector<Field> scan_fields(ScanSettings& settings);
/// Those of them that need no new capture.
std::vector<Field> model_fields(ScanSettings& settings);
std::vector<Field> fields(Limits& limits);
std::vector<Field> fields(ModelSettings& settings);

/// What a model of a scan by laser line has by default: finer than a depth sensor's.
void use_laser_defaults(ScanSettings& settings);

/// The settings of the reconstruction among them.
ReconstructOptions reconstruct_options(const ScanSettings& settings, const Limits& limits);

/// As the API and the files have them: lengths in millimetres, each key with its unit.
nlohmann::json to_json(const ScanSettings& settings);

/// Reads the settings of a scan to come; a key that is not given is as in `defaults`.
///
/// @param name  of the object in messages; empty for the outermost
/// @throws Error "bad-settings"  that names the key, its value and what is allowed; also for a key
///                               that is none
ScanSettings settings_from(const nlohmann::json& object, const ScanSettings& defaults,
                           const std::string& name = "");

/// Reads the settings of a scan that was made. It may have a clip box thinner than a leaf, which
/// version 0.1 took.
/// @throws Error  as above, of the value's code
ScanSettings stored_settings_from(const JsonValue& object);

/// Refuses a leaf larger than the root. @param keys  in which the settings were given
void check_leaf(const JsonObject& keys, const ScanSettings& settings);

/// Refuses a clip box thinner than a leaf. @param keys  as above
void check_clip(const JsonObject& keys, const ScanSettings& settings);

}  // namespace octurn
