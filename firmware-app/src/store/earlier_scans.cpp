#include "store/earlier_scans.hpp"

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "store/data_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_earlier_scans = 20;

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const std::string& name : names_in(folder)) {
    std::error_code gone;
    const std::uintmax_t size = fs::file_size(folder / name, gone);
    bytes += gone ? 0 : size;
  }
  return bytes;
}

}  // namespace

std::vector<EarlierScan> earlier_scans(const ScanStore& store) {
  std::vector<EarlierScan> scans;
  for (Job& job : store.list()) {
    if (job.state == JobState::finished && scans.size() < max_earlier_scans) {
      const std::uint64_t bytes = bytes_in(store.folder(job.id) / "snapshots");
      scans.push_back({.job = std::move(job), .snapshot_bytes = bytes});
    }
  }
  return scans;
}

}  // namespace octurn
