#include "http/handlers/archives.hpp"

#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <semaphore>
#include <string>
#include <system_error>

#include "http/file_response.hpp"
#include "http/handlers/models.hpp"
#include "http/json_body.hpp"
#include "http/place.hpp"
#include "http/scan_view.hpp"
#include "octurn/error.hpp"
#include "store/scan_archive.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_archive_bytes = std::uint64_t{1} << 30U;

// One archive is packed at a time, and no request waits for it: on a Pi that takes minutes, and
// each would occupy a thread of the server, where nobody cuts its connection.
std::counting_semaphore<> packing_places{1};

std::counting_semaphore<> import_places{2};  // uploads may take hours

/// A folder or file that is removed at the end of its scope.
class Scratch {
 public:
  explicit Scratch(fs::path path) : path_(std::move(path)) {}
  ~Scratch() {
    std::error_code ignored;  // the next start of the program removes leftovers
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool is_of_disk(ErrorCode code) {
  return code == ErrorCode::disk_full || code == ErrorCode::write_failed ||
         code == ErrorCode::data_failed;
}

}  // namespace

Response send_archive(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  if (job.state == JobState::running) {
    throw Error(ErrorCode::busy, "this scan is running", "Wait for its end.");
  }
  if (job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  const Place place(&packing_places, "an archive is being packed for others");
  const std::string name = ".export-" + job.id + ".zip";
  const auto packed_in = [&](const fs::path& folder) {
    const Scratch archive(folder / name);
    std::async(std::launch::async, write_scan_archive, app.store.folder(id), archive.path()).get();
    return file_response(request, archive.path(), "application/zip",
                         download_name(job, ".zip"));  // its open descriptor outlives the removal
  };
  try {
    return packed_in(app.store.data() / "scans");
  } catch (const Error& error) {
    if (!is_of_disk(error.code())) {
      throw;
    }
  }
  // The disk is full or read-only, which is when somebody wants to save the scans.
  return packed_in(fs::temp_directory_path());
}

Response import_scan(App& app, const Request& request) {
  if (!request.upload.length) {
    throw Error(ErrorCode::length_required, "the scan comes without its length",
                "Send it with Content-Length, not in chunks.");
  }
  if (*request.upload.length > max_archive_bytes) {
    throw Error(ErrorCode::too_large, "a scan has at most 1 GiB", "Send a file scan.zip.");
  }
  const Place place(&import_places, "others are sending scans");
  const Job job = app.scanner.adopt({.bytes = *request.upload.length, .read = request.upload.read});
  Response response = json_response(to_json(app, find_scan(app, job.id)), 201);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job.id);
  return response;
}

}  // namespace octurn
