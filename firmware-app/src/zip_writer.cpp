#include "zip_writer.hpp"

#include <fcntl.h>
#include <minizip/zip.h>
#include <unistd.h>

#include <system_error>
#include <utility>

#include "file_descriptor.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void throw_full(const fs::path& file) {
  throw Error(ErrorCode::disk_full, file.string() + ": cannot be written",
              "Delete scans that are no longer needed.", {{"path", file.string()}});
}

}  // namespace

struct ZipWriter::Archive {
  zipFile zip = nullptr;
  bool has_file = false;

  /// Closes the open file, if there is one. @return false if that failed
  bool close_file() { return !std::exchange(has_file, false) || zipCloseFileInZip(zip) == ZIP_OK; }
  bool close() {
    const bool closed = close_file();
    return zipClose(std::exchange(zip, nullptr), nullptr) == ZIP_OK && closed;
  }
};

ZipWriter::ZipWriter(fs::path target)
    : target_(std::move(target)),
      temporary_(temporary_name(target_, 0)),
      archive_(std::make_unique<Archive>()) {
  archive_->zip = zipOpen64(temporary_.c_str(), APPEND_STATUS_CREATE);
  if (archive_->zip == nullptr) {
    throw Error(ErrorCode::write_failed, temporary_.string() + ": cannot be made",
                "Check that this program may write there.");
  }
}

ZipWriter::~ZipWriter() {
  if (archive_->zip != nullptr) {
    archive_->close();
  }
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void ZipWriter::begin(const std::string& name, ZipMethod method) {
  zip_fileinfo info{};
  info.tmz_date = {
      .tm_sec = 0, .tm_min = 0, .tm_hour = 0, .tm_mday = 1, .tm_mon = 0, .tm_year = 1980};
  const bool begun = archive_->close_file() &&
                     zipOpenNewFileInZip64(archive_->zip, name.c_str(), &info, nullptr, 0, nullptr,
                                           0, nullptr, method == ZipMethod::stored ? 0 : Z_DEFLATED,
                                           Z_DEFAULT_COMPRESSION, 0) == ZIP_OK;
  if (!begun) {
    throw_full(temporary_);
  }
  archive_->has_file = true;
}

void ZipWriter::write(std::string_view bytes) {
  if (zipWriteInFileInZip(archive_->zip, bytes.data(), static_cast<unsigned>(bytes.size())) !=
      ZIP_OK) {
    throw_full(temporary_);
  }
}

void ZipWriter::commit() {
  if (!archive_->close()) {
    throw_full(temporary_);
  }
  const FileDescriptor file(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
  std::error_code error;
  if (!file.is_open() || ::fsync(file.number()) != 0) {
    throw_full(temporary_);
  }
  fs::rename(temporary_, target_, error);
  if (error) {
    throw_full(target_);
  }
  sync_folder(target_.parent_path());
}

}  // namespace octurn
