#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "store/job_file.hpp"
#include "store/scan_archive.hpp"
#include "store/scan_store.hpp"
#include "support/archive.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"
#include "zip_file.hpp"

namespace octurn {

/// The scan.json of a scan whose snapshots all name one image.
inline nlohmann::json one_image_scan(int snapshots, int width = 4, int height = 3) {
  nlohmann::json scan = scan_json_of(snapshots, width, height);
  for (nlohmann::json& snapshot : scan["snapshots"]) {
    snapshot["file"] = "snapshots/000.png";
  }
  return scan;
}

inline std::vector<ArchivedFile> files_of(const nlohmann::json& scan) {
  return {{"scan.json", scan.dump()}, {"snapshots/000.png", depth_png_of(4, 3)}};
}

/// Whether both documents are the same. A number in millimetres may differ in its last digit, as it
/// was converted to metres and back.
inline bool is_same(const nlohmann::json& one, const nlohmann::json& other) {
  if (one.is_number() && other.is_number()) {
    const auto a = one.get<double>();
    const auto b = other.get<double>();
    return std::abs(a - b) <= 1e-12 * std::abs(a);
  }
  if (one.type() != other.type() || !one.is_structured()) {
    return one == other;
  }
  const nlohmann::json flat = one.flatten();
  const nlohmann::json other_flat = other.flatten();
  return flat.size() == other_flat.size() &&
         std::ranges::all_of(flat.items(), [&](const auto& item) {
           return other_flat.contains(item.key()) && is_same(item.value(), other_flat[item.key()]);
         });
}

class ScanImport : public ::testing::Test {
 protected:
  /// Imports an archive as `Scanner::adopt` does.
  static Job import(ScanStore& store, const std::vector<ArchivedFile>& files,
                    const std::stop_token& stop = {}) {
    const std::filesystem::path folder = store.begin_import();
    try {
      put(folder / ".scan.zip", make_zip(files, {}));
      read_scan_archive(folder / ".scan.zip", folder, stop);
      std::filesystem::remove(folder / ".scan.zip");
      return store.adopt(folder);
    } catch (...) {
      std::filesystem::remove_all(folder);
      throw;
    }
  }

  Error refusal(const std::vector<ArchivedFile>& files) {
    ScanStore store(data_.path());
    const Error error = error_thrown_by([&] { import(store, files); });
    EXPECT_TRUE(store.list().empty());
    return error;
  }

  /// Has `take` import each of `count` scans; some may be refused. Expects a new store to have
  /// those that were not, and that each is as it was. @return how many these are
  std::size_t imported_and_read_back(
      std::size_t count, const std::function<Job(ScanStore& store, std::size_t scan)>& take) {
    std::vector<Job> jobs;
    {
      ScanStore store(data_.path());
      for (std::size_t i = 0; i < count; ++i) {
        try {
          jobs.push_back(take(store, i));
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::bad_request) << error.what();
        }
      }
    }
    const ScanStore store(data_.path());
    EXPECT_EQ(store.list().size(), jobs.size());
    for (const Job& job : jobs) {
      const nlohmann::json found = to_job_json(store.get(job.id));
      EXPECT_TRUE(is_same(found, to_job_json(job))) << found << "\n" << to_job_json(job);
      EXPECT_EQ(found["state"], "interrupted") << found["error"];
    }
    return jobs.size();
  }

  /// As above, from archives of these files.
  std::size_t imported_and_read_back(const std::vector<std::vector<ArchivedFile>>& archives) {
    return imported_and_read_back(archives.size(), [&](ScanStore& store, std::size_t i) {
      return import(store, archives[i]);
    });
  }

  TemporaryFolder data_;
};

}  // namespace octurn
