#include "capture/take_stop.hpp"

#include <utility>

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

PictureWriter::PictureWriter(std::filesystem::path folder, std::vector<std::string> files)
    : folder_(std::move(folder)), files_(std::move(files)) {}

void PictureWriter::add(Picture picture, std::vector<Rgb> colours) {
  finish();
  writing_ = std::async(std::launch::async,
                        [file = folder_ / files_.at(added_++), picture = std::move(picture),
                         colours = std::move(colours)] { write_picture(file, picture, colours); });
}

void PictureWriter::finish() {
  if (writing_.valid()) {
    writing_.get();
  }
}

}  // namespace octurn
