#include "sensor/new_folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "file_descriptor.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw Error(ErrorCode::write_failed, file.string() + ": " + what,
              "Name a folder that does not exist yet, where this program may write.");
}

/// Writes the folder's file system to disk (syncfs(2)).
void sync_disk_of(const fs::path& folder) {
  const FileDescriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened.is_open() || ::syncfs(opened.number()) != 0) {
    fail(folder, "cannot be synced");
  }
}

}  // namespace

NewFolder::NewFolder(fs::path folder)
    : folder_(folder.has_filename() ? std::move(folder) : folder.parent_path()) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder_, error))) {
    fail(folder_, "is there already");
  }
  if (folder_.has_parent_path()) {
    fs::create_directories(folder_.parent_path(), error);
  }
  for (int attempt = 0; temporary_.empty(); ++attempt) {
    const fs::path wanted = temporary_name(folder_, attempt);
    if (fs::create_directory(wanted, error)) {
      temporary_ = wanted;
    } else if (error) {
      fail(folder_, "cannot be made: " + error.message());
    }
  }
}

NewFolder::~NewFolder() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void NewFolder::commit() {
  sync_disk_of(temporary_);
  std::error_code error;
  fs::rename(temporary_, folder_, error);
  if (error) {
    fail(folder_, "cannot be made: " + error.message());
  }
  sync_disk_of(folder_);
}

}  // namespace octurn
