#include "capture/take_stop.hpp"

#include "capture/picture_writer.hpp"
#include "capture/take_pictures.hpp"
#include "store/stored_scan.hpp"

namespace octurn {

bool take_stop(Rig& rig, const Stop& at, double angle, const std::filesystem::path& folder,
               Scan& scan, const std::stop_token& stop, const ScanObserver& observer) {
  PictureWriter writer(folder, picture_files(static_cast<int>(scan.shots.size()), *scan.laser));
  const auto write = [&](const Picture& picture, const std::vector<Rgb>& colours) {
    writer.add(picture, colours);
  };
  if (!take_pictures(rig, at, stop, observer, write)) {
    return false;
  }
  writer.finish();
  store_stop(folder, scan, angle);
  observer.on_progress(Phase::capturing, static_cast<int>(scan.shots.size()));
  return true;
}

}  // namespace octurn
