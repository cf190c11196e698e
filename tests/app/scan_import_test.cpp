// What is imported from an archive is there after a restart.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/scan_import_fixture.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A job with every optional part that an import keeps.
Job full_job() {
  Job job{.state = JobState::finished, .phase = Phase::done, .snapshots_done = 2};
  job.times = {.created = "2026-11-21T08:15:00Z", .elapsed = std::chrono::seconds(90)};
  job.settings.snapshots = 2;
  job.calibration = ScanCalibration{
      .accepted = true,
      .solved = SolvedPose{.position_sigma = 0.0003, .direction_sigma = 0.002, .before = 0.002},
      .findings = {{.code = "tilted", .detail = "a", .hint = "b", .stop = 1, .angle = 0.5}}};
  job.model = Model{.report = {.triangles = 4}};
  return job;
}

TEST_F(ScanImport, OfMoreSnapshotsThanARequestMayHaveIsThereAfterARestart) {
  EXPECT_EQ(imported_and_read_back({files_of(one_image_scan(400)), files_of(one_image_scan(408)),
                                    files_of(one_image_scan(4000))}),
            3U);
  EXPECT_EQ(ScanStore(data_.path()).list().front().settings.snapshots, 4000);
}

TEST_F(ScanImport, OfTooManySnapshotsIsRefused) {
  const Error error = refusal(files_of(one_image_scan(4001)));
  EXPECT_EQ(error.code(), ErrorCode::bad_request);
  EXPECT_NE(std::string(error.what()).find("4001 snapshots: must have at most 4000"),
            std::string::npos)
      << error.what();
}

TEST_F(ScanImport, KeepsAClipBoxThatItAccepts) {
  const auto with_clip = [](double side) {
    json scan = one_image_scan(2);
    scan["clip_m"] = {{"min", {0, 0, 0}}, {"max", {side, side, side}}};
    return files_of(scan);
  };
  EXPECT_EQ(imported_and_read_back({with_clip(10.1), with_clip(1000), with_clip(1e-8)}), 3U);
  const TemporaryFolder other;
  ScanStore store(other.path());
  for (const double side : {1000.1, 1e6, 1e9, 1e-10, 1e-300, 1e308}) {
    const Error error = error_thrown_by([&] { import(store, with_clip(side)); });
    EXPECT_EQ(error.code(), ErrorCode::bad_request) << side;
    EXPECT_NE(std::string(error.what()).find("clip_m"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(store.list().empty());
}

TEST_F(ScanImport, IsReadBackByTheNextStartWhateverItsJobSays) {
  const json job = to_job_json(full_job());
  const std::vector<json> values{-1,
                                 0,
                                 1e-10,
                                 401,
                                 4001,
                                 4e9,
                                 1e15,
                                 1e308,
                                 "x",
                                 true,
                                 nullptr,
                                 json::array(),
                                 json::object(),
                                 std::string(1000, 'x')};
  std::vector<json> changed;
  std::size_t next = 0;
  const json leaves = job.flatten();
  for (const auto& [path, ignored] : leaves.items()) {
    // Every third value, beginning with another one at each key: each import waits for the disk.
    for (; next < values.size(); next += 3) {
      changed.push_back(job);
      changed.back()[json::json_pointer(path)] = values[next];
    }
    next -= values.size();
  }
  const std::size_t accepted =
      imported_and_read_back(changed.size(), [&](ScanStore& store, std::size_t i) {
        const fs::path folder = store.begin_import();
        for (const ArchivedFile& file : files_of(one_image_scan(2))) {
          put(folder / file.name, file.content);
        }
        put(folder / "job.json", changed[i].dump());
        return store.adopt(folder);
      });
  EXPECT_GT(accepted, changed.size() / 10);
  EXPECT_LT(accepted, changed.size());
}

TEST_F(ScanImport, KeepsTheTimeThatTheScanTookWithinTheClocksRange) {
  for (const double seconds : {1e308, -9223372036.797, 1e9, 12.5}) {
    SCOPED_TRACE(seconds);
    const TemporaryFolder folder;
    json job = to_job_json(full_job());
    job["seconds_elapsed"] = seconds;
    std::vector<ArchivedFile> files = files_of(one_image_scan(2));
    files.push_back({"job.json", job.dump()});
    std::string id;
    {
      ScanStore store(folder.path());
      id = import(store, files).id;
    }
    EXPECT_EQ(ScanStore(folder.path()).get(id).times.elapsed.count(),
              std::clamp(seconds, 0.0, 1e9));
  }
}

TEST_F(ScanImport, IsRefusedIfItsJobWouldBeTooLargeToBeRead) {
  json job = to_job_json(full_job());
  const json finding = job["calibration"]["findings"][0];
  for (int i = 0; i < 6000; ++i) {
    job["calibration"]["findings"].push_back(finding);
  }
  std::vector<ArchivedFile> files = files_of(one_image_scan(2));
  files.push_back({"job.json", job.dump()});
  ASSERT_LT(files.back().content.size(), max_job_bytes);
  EXPECT_EQ(refusal(files).code(), ErrorCode::bad_request);
}

TEST_F(ScanImport, IsRefusedWhereItsJobCannotBeRead) {
  for (const std::string& job :
       {std::string(), std::string("{"), std::string("[]"), std::string(max_job_bytes + 1, ' ')}) {
    std::vector<ArchivedFile> files = files_of(one_image_scan(2));
    files.push_back({"job.json", job});
    const Error error = refusal(files);
    EXPECT_EQ(error.code(), ErrorCode::bad_request);
    EXPECT_NE(std::string(error.what()).find("job.json"), std::string::npos) << error.what();
  }
}

TEST_F(ScanImport, HasNoDateThatIsLongerThanOne) {
  json job = to_job_json(full_job());
  job["created"] = std::string(900, '2');
  std::vector<ArchivedFile> files = files_of(one_image_scan(2));
  files.push_back({"job.json", job.dump()});
  EXPECT_EQ(imported_and_read_back({files}), 1U);
  EXPECT_LT(ScanStore(data_.path()).list().front().times.created.size(), 30U);
}

TEST_F(ScanImport, DropsALabelThatCannotBeOneAlsoFromTheDisk) {
  std::vector<ArchivedFile> files = files_of(one_image_scan(2));
  files.push_back({"name.txt", std::string(200, 'x')});
  files.push_back({"notes.txt", "a note\nof two lines"});
  files.push_back({"tags.txt", "one\none\n"});
  files.push_back({"author.txt", "Jane Doe"});
  EXPECT_EQ(imported_and_read_back({files}), 1U);
  const Job job = ScanStore(data_.path()).list().front();
  EXPECT_EQ(job.label.name, "");
  EXPECT_EQ(job.label.notes, "a note\nof two lines");
  EXPECT_EQ(job.label.tags, "");
  EXPECT_EQ(job.label.author, "Jane Doe");
}

}  // namespace
}  // namespace octurn
