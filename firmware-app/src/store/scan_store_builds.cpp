// ScanStore: builds of scans.

#include <algorithm>
#include <string>
#include <utility>

#include "log.hpp"
#include "octurn/file.hpp"
#include "store/build_file.hpp"
#include "store/scan_store.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

// As for scans: the next start removes folders whose names begin with a dot.
fs::path unfinished_in(const fs::path& builds, int number) {
  return builds / (".new-" + std::to_string(number));
}

fs::path leaving_in(const fs::path& builds, int number) {
  return builds / (".removed-" + std::to_string(number));
}

[[noreturn]] void throw_no_such_build(int number) {
  throw Error(ErrorCode::no_model, "this scan has no build " + std::to_string(number),
              "GET /api/v1/scans/ID/builds lists its builds.");
}

}  // namespace

int ScanStore::next_build(std::string_view id) const {
  get(id);  // throws if there is no such scan
  return next_build_number(folder(id));
}

fs::path ScanStore::begin_build(std::string_view id, int number) {
  get(id);  // throws if there is no such scan
  make_room(max_model_bytes(), "a model");
  const fs::path beginning = unfinished_in(folder(id) / builds_folder, number);
  std::error_code error;
  fs::create_directories(beginning, error);
  if (error) {
    throw_data_error(beginning, "make the folder", error);
  }
  return beginning / "Scan.stl";
}

void ScanStore::add_build(std::string_view id, const Build& build) {
  const std::lock_guard writing(writing_);
  get(id);  // throws if there is no such scan
  const fs::path builds = folder(id) / builds_folder;
  const fs::path beginning = unfinished_in(builds, build.number);
  const fs::path kept = builds / std::to_string(build.number);
  write_build(beginning, build);
  std::error_code error;
  fs::rename(beginning, kept, error);
  if (error) {
    throw_data_error(kept, "make the folder", error);
  }
  sync_folder(builds);
  sync_folder(folder(id));  // may have a new entry, `builds`
  const std::lock_guard lock(mutex_);
  jobs_.find(id)->second.builds.all.push_back(build);
  ++revision_;
}

fs::path ScanStore::reserve_build(BuildRun& run) {
  make_room(max_model_bytes(), "a model");
  const std::lock_guard writing(writing_);
  run.number = next_build(run.scan);
  fs::path kept = model_file(run.scan, run.number).parent_path();
  std::error_code error;
  fs::create_directories(kept, error);
  if (error) {
    throw_data_error(kept, "make the folder", error);
  }
  return kept;
}

void ScanStore::take_build(std::string_view id, int number) {
  const std::lock_guard writing(writing_);
  const Job job = get(id);
  if (find_build(job, number) != nullptr) {
    return;  // finished while no daemon ran, and read at its start
  }
  Build build = read_build(model_file(id, number).parent_path(), number);
  const std::lock_guard lock(mutex_);
  jobs_.find(id)->second.builds.all.push_back(std::move(build));
  ++revision_;
}

void ScanStore::release_build(std::string_view id, int number) {
  const fs::path builds = folder(id) / builds_folder;
  std::error_code ignored;  // the next start removes leftovers
  fs::rename(builds / std::to_string(number), leaving_in(builds, number), ignored);
  fs::remove_all(leaving_in(builds, number), ignored);
}

void ScanStore::drop_build(std::string_view id, int number) {
  std::error_code ignored;  // the next start removes leftovers
  fs::remove_all(unfinished_in(folder(id) / builds_folder, number), ignored);
}

void ScanStore::choose_build(std::string_view id, int number) {
  update(id, [&](Job& job) {
    if (number == 0 ? !job.model : find_build(job, number) == nullptr) {
      throw_no_such_build(number);
    }
    job.builds.chosen = number;
  });
}

void ScanStore::remove_build(std::string_view id, int number) {
  const fs::path builds = folder(id) / builds_folder;
  const fs::path leaving = leaving_in(builds, number);
  std::error_code error;
  {
    const std::lock_guard writing(writing_);
    const Job job = get(id);
    if (number == 0 || job.builds.chosen == number) {
      throw Error(ErrorCode::busy,
                  number == 0 ? "this model belongs to the scan" : "this is the scan's model",
                  number == 0 ? "It goes with the scan." : "Choose another one first.");
    }
    if (find_build(job, number) == nullptr) {
      throw_no_such_build(number);
    }
    // Renamed first, so that a partly removed build is never listed.
    fs::rename(builds / std::to_string(number), leaving, error);
    if (error && error != std::errc::no_such_file_or_directory) {
      throw_data_error(builds / std::to_string(number), "remove", error);
    }
    const std::lock_guard lock(mutex_);
    std::erase_if(jobs_.find(id)->second.builds.all,
                  [&](const Build& build) { return build.number == number; });
    ++revision_;
  }
  fs::remove_all(leaving, error);
  if (error) {
    log::warning("store", leaving.string() + ": cannot remove: " + error.message());
  }
}

fs::path ScanStore::model_file(std::string_view id) const {
  const std::optional<Job> job = find(id);
  return model_file(id, job && find_build(*job, job->builds.chosen) ? job->builds.chosen : 0);
}

fs::path ScanStore::model_file(std::string_view id, int build) const {
  return build == 0 ? folder(id) / "Scan.stl"
                    : folder(id) / builds_folder / std::to_string(build) / "Scan.stl";
}

}  // namespace octurn
