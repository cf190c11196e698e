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

/// Returns the number of processors, at least 1.
int available_threads();

/// Returns half of the machine's memory, bytes, rounded down to whole MB: the rest is for the
/// system.
std::size_t half_of_memory();

/// Source of the sensor's pose that a model is made with.
enum class PoseSource {
  solved,      ///< the scan's solved pose, else one solved from its snapshots if that is accepted
  configured,  ///< the configured pose
};

/// The source's name in settings: "auto", "told".
std::string_view to_string(PoseSource source);

/// Range of the factor of a sensor's depths: a larger error has another cause.
inline constexpr double min_depth_scale = 0.9;
inline constexpr double max_depth_scale = 1.1;

/// Ranges of settings that are wider in files than in requests.
struct SettingRanges {
  int max_snapshots;
  double max_coordinate_mm;  ///< of the clip box
};

/// Of a request. A laser's lines are 0.9 degrees apart with 400 snapshots in a turn. No depth
/// sensor of this kind sees farther than 10 m.
inline constexpr SettingRanges requested_ranges{.max_snapshots = 400, .max_coordinate_mm = 10'000};

/// Of a stored scan, which may be imported: it may be merged of several turns, and have the clip
/// box of a larger rig. Scans beyond these ranges are not imported.
inline constexpr SettingRanges stored_ranges{.max_snapshots = 4000, .max_coordinate_mm = 1'000'000};

/// The settings of a scan.
struct ScanSettings {
  int snapshots = SensorTraits{}.stops;  ///< in a turn
  DepthFilter filter = DepthFilter::average;
  int frames = 10;  ///< at each stop, for filters that merge frames
  Method method = Method::solid;
  double leaf_size = SensorTraits{}.leaf_size;  ///< metres
  double threshold = 0.0001;  ///< square metres: square of a triangle's longest side; intersection
  double target_error = SensorTraits{}.target_error;  ///< metres; solid
  Parts parts = Parts::main;                          ///< solid
  double root_size = 1.0;                             ///< metres
  /// Metres, platform frame. Its bottom is at 5 mm, above the noise of a Kinect v1 on the platform.
  Box clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}};
  PoseSource pose = PoseSource::solved;
  /// Configured pose: optical frame to platform frame, metres.
  Eigen::Isometry3d platform_from_sensor = nominal_platform_from_sensor();
  double depth_scale = 1;  ///< factor of the sensor's depths
};

/// The resources that a reconstruction may use. No byte of a model depends on them.
struct Limits {
  int threads = available_threads();
  std::size_t memory_bytes = half_of_memory();  ///< for the whole process; 0 is no limit
};

/// The settings of one model that are no settings of a scan.
struct EditSettings {
  ModelEdits edits = {};
  std::optional<int> max_triangles = {};  ///< `solid` only
};

/// The settings of `octurn reconstruct`. Those of `model_options` are its defaults.
struct ModelSettings {
  ScanSettings scan = {};
  std::optional<int> level = {};  ///< `intersection` only: draws the surface of this coarser level
  EditSettings edits = {};
  Limits limits = {.memory_bytes = 0};
};

struct Field;

/// All settings of a scan, each with its key, unit and range.
std::vector<Field> fields(ScanSettings& settings, const SettingRanges& ranges = requested_ranges);
/// The settings of `octurn scan`: all except the sensor's pose and depth scale.
std::vector<Field> scan_fields(ScanSettings& settings,
                               const SettingRanges& ranges = requested_ranges);
/// The settings of a model, which need no new capture.
std::vector<Field> model_fields(ScanSettings& settings,
                                const SettingRanges& ranges = requested_ranges);
std::vector<Field> fields(EditSettings& settings);
std::vector<Field> fields(Limits& limits);
std::vector<Field> fields(ModelSettings& settings);

/// Sets the defaults of a model of a scan by laser line, which is finer than a depth sensor's.
void use_laser_defaults(ScanSettings& settings);

/// Adds edits to the options of a reconstruction.
void add_edits(ReconstructOptions& options, const EditSettings& settings);

/// Converts settings to the options of a reconstruction.
ReconstructOptions reconstruct_options(const ScanSettings& settings, const Limits& limits);

/// JSON of settings, for the API and the files: lengths in millimetres, each key with its unit.
nlohmann::json to_json(const ScanSettings& settings);

/// Reads the settings of a new scan; a missing key has the value of `defaults`.
///
/// @param name  of the object in messages; empty for the outermost
/// @throws Error "bad-settings"  with the key, its value and the allowed range; also for an unknown
///                               key
ScanSettings settings_from(const nlohmann::json& object, const ScanSettings& defaults,
                           const std::string& name = "");

/// Reads the settings of a stored scan, with `stored_ranges`. Its clip box may be thinner than a
/// leaf, as in version 0.1.
/// @throws Error  as above, with the code of `object`
ScanSettings stored_settings_from(const JsonValue& object);

/// Refuses edits that the method does not make. @param keys  as below
void check_edits(const JsonObject& keys, const EditSettings& edits, Method method);

/// Refuses a leaf larger than the root, or smaller than an octree's leaves in it can be.
/// @param keys  the JSON of the settings, for messages
void check_leaf(const JsonObject& keys, const ScanSettings& settings);

/// Refuses a clip box thinner than a leaf. @param keys  as above
void check_clip(const JsonObject& keys, const ScanSettings& settings);

}  // namespace octurn
