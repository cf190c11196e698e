#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// What a camera sees at a stop.
struct StopPictures {
  std::vector<Picture> pictures = {};  ///< one without a laser, then one with each, in their order
  std::vector<Rgb> colours = {};       ///< the first one's; empty if the camera has none
};

/// Given each picture as soon as it was taken, with its colours if the camera has any.
using KeepPicture = std::function<void(const Picture& picture, const std::vector<Rgb>& colours)>;

/// Keeps none.
inline void keep_no_picture(const Picture& /*picture*/, const std::vector<Rgb>& /*colours*/) {}

/// Turns to a stop and takes its pictures: one without a laser, then one with each, in their order.
/// Each is exposed as a whole after the platform stood still and the laser was switched.
///
/// @param keep  called while all lasers are off
/// @return nothing if stopped first: then, as after every error, all lasers are off
/// @throws Error "sensor-blind"  if the room is too bright, or a laser's line is not seen; and
///               "sensor-...", "turntable-..."
std::optional<StopPictures> take_pictures(Rig& rig, const Stop& at, const std::stop_token& stop,
                                          const ScanObserver& observer,
                                          const KeepPicture& keep = keep_no_picture);

/// The same where the platform stands.
std::optional<StopPictures> take_pictures_here(Rig& rig, const std::stop_token& stop,
                                               const ScanObserver& observer,
                                               const KeepPicture& keep = keep_no_picture);

/// A picture without a laser has to be dark enough to show lines.
/// @throws Error "sensor-blind"
void expect_dark_room(const Picture& dark, const std::string& camera);

/// A laser that works shows on something in any picture: on the object, the platform, or what lies
/// around them.
/// @param laser  its name
/// @throws Error "sensor-blind"
void expect_line(const Picture& dark, const Picture& lit, const std::string& laser);

/// Turns a rig with lasers to a stop and takes its pictures into a scan folder. Each is written
/// while the next one is taken; all of them, and the scan.json that names them, are on the disk
/// when this returns.
///
/// @param angle  of the platform there, radians
/// @return false if stopped first
/// @throws Error  as `take_pictures`, and "disk-full", "write-failed"
bool take_stop(Rig& rig, const Stop& at, double angle, const std::filesystem::path& folder,
               Scan& scan, const std::stop_token& stop, const ScanObserver& observer);

/// Writes the pictures of one stop, each while the camera takes the next one. The destructor waits
/// for the one that is written.
class PictureWriter {
 public:
  /// @param folder  of the scan
  /// @param files   of the stop's pictures in it, in the order in which they are added
  PictureWriter(std::filesystem::path folder, std::vector<std::string> files);

  /// Begins to write the next picture, as RGB if any pixel has a colour.
  /// @param colours  of its pixels; empty if the camera has none
  /// @throws Error "disk-full", "write-failed"  of the picture before
  void add(Picture picture, std::vector<Rgb> colours);

  /// Returns when all are on the disk. @throws Error  as above
  void finish();

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_;
  std::size_t added_ = 0;
  std::future<void> writing_;  // at most one picture
};

}  // namespace octurn
