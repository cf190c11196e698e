#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/quality.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "settings/scan_settings.hpp"
#include "store/job.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// Whether two scans have equal intrinsics, and, by laser line, the same distortion and names of
/// lasers. The lasers' planes may differ: they may have been measured in between.
bool have_same_sensor(const Scan& one, const Scan& other);

/// Returns the snapshots of a scan folder. A damaged one is logged, and replaced by one without
/// readings: the others still make a model.
///
/// @param stop  once requested, a read throws `Stopped`
SnapshotSource readable_snapshots(const std::filesystem::path& folder, const Scan& scan,
                                  const std::stop_token& stop);

/// Stores one more snapshot: first its image, then the scan.json that names it.
/// @throws Error "disk-full", "write-failed"
void store_snapshot(const std::filesystem::path& folder, Scan& scan, const Shot& shot,
                    const DepthFrame& frame);

/// Returns the files of a stop's pictures in a laser-line scan: "snapshots/000-dark.png", then one
/// for each laser by its name.
std::vector<std::string> picture_files(int stop, const LaserCamera& camera);

/// Writes one of these pictures, as RGB if any of its pixels has a colour.
/// @param colours  of its pixels; empty if the camera has none
/// @throws Error  as above
void write_picture(const std::filesystem::path& file, const Picture& picture,
                   const std::vector<Rgb>& colours);

/// Appends a stop whose pictures are all written, and writes the scan.json that names them.
/// @throws Error  as above
void store_stop(const std::filesystem::path& folder, Scan& scan, double angle);

/// Whether the first dark picture of a laser-line scan has colours; false if it cannot be read, and
/// for other scans.
bool has_colours(const std::filesystem::path& folder, const Scan& scan);

/// Reads a stored scan and applies a build's settings to it. The sensor's pose is not solved yet.
/// @throws Error "bad-settings"  if the settings have a pose, and the scan has several; and as
///                               `read_scan`
Scan scan_to_build(const std::filesystem::path& folder, const BuildSettings& settings);

/// A scan folder, and the scan in it.
struct ModelScan {
  std::filesystem::path folder = {};
  Scan scan = {};
  ModelEdits edits = {};  ///< of the model
};

/// Returns the scan of a model, with the poses of sensor and object that the model was made with.
/// @param build  number of the model's build; 0: the scan's own model
/// @throws Error "no-model"  if there is no such build; and as `read_scan`
ModelScan scan_of_model(const ScanStore& store, const Job& job, int build);

/// Returns options for a model whose snapshots are also checked. `program_memory` includes the
/// memory of the checks, and of solving the pose if the settings ask for it.
ReconstructOptions checked_options(const ScanSettings& settings, const Limits& limits,
                                   std::size_t snapshots);

}  // namespace octurn
