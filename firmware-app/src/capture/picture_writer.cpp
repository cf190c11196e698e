#include "capture/picture_writer.hpp"

#include <utility>

#include "store/stored_scan.hpp"

namespace octurn {

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
