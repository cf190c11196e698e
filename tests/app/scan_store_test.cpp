#include "scan/scan_store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>

#include "octurn/depth_png.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/job_file.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// A folder of scans, as a process that was killed would leave it when `leave` returns.
void leave_behind(const fs::path& data, const std::function<void(ScanStore&)>& leave) {
  ScanStore store(data);
  leave(store);
}

TEST(ScanId, HasOneFormOnly) {
  EXPECT_TRUE(is_scan_id("20261121-081500-3f2a"));
  for (const char* const text :
       {"", ".", "..", "../../etc/passwd", "20261121-081500-3f2", "20261121-081500-3f2a/",
        "20261121-081500-3F2A", "2026112a-081500-3f2a", "20261121/081500-3f2a",
        "20261121-081500-3f2a\n", "20261121-081500-3f2g"}) {
    EXPECT_FALSE(is_scan_id(text)) << text;
  }
}

TEST(ScanStore, GivesANewScanAnIdAndKeepsWhatWasAskedFor) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  ScanSettings settings;
  settings.snapshots = 5;
  const Job job = store.create(settings);
  EXPECT_TRUE(is_scan_id(job.id)) << job.id;
  const auto found = store.find(job.id);
  ASSERT_TRUE(found);
  EXPECT_EQ(to_job_json(*found), to_job_json(job));
  EXPECT_EQ(found->state, JobState::running);
  EXPECT_EQ(found->settings.snapshots, 5);
}

TEST(ScanStore, ReturnsAFinishedScanAsItWasSaved) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  Job job = store.create({});
  job.state = JobState::finished;
  job.phase = Phase::done;
  job.snapshots_done = 36;
  job.elapsed = std::chrono::milliseconds(12345);
  job.model = Model{.report = {.leaves = 11,
                               .triangles = 22,
                               .bytes = 1184,
                               .watertight = true,
                               .volume = 0.000123,
                               .size = {0.12, 0.095, 0.151}},
                    .build_time = std::chrono::milliseconds(80)};
  store.save(job);
  const auto found = store.find(job.id);
  ASSERT_TRUE(found && found->model);
  EXPECT_EQ(to_job_json(*found), to_job_json(job));
  EXPECT_NEAR(found->model->report.volume, 0.000123, 1e-12);
  EXPECT_EQ(store.newest_finished()->id, job.id);
}

TEST(ScanStore, ListsTheNewestFirst) {
  const TemporaryFolder folder;
  for (const char* const id :
       {"20261121-081500-aaaa", "20251231-235959-ffff", "20270101-000000-0000"}) {
    Job job{.id = id, .created = "2026-11-21T08:15:00Z"};
    job.state = JobState::cancelled;
    put(folder.path() / "scans" / id / "job.json", to_job_json(job).dump());
  }
  ScanStore store(folder.path());
  const std::vector<Job> jobs = store.list();
  ASSERT_EQ(jobs.size(), 3U);
  EXPECT_EQ(jobs[0].id, "20270101-000000-0000");
  EXPECT_EQ(jobs[1].id, "20261121-081500-aaaa");
  EXPECT_EQ(jobs[2].id, "20251231-235959-ffff");
  EXPECT_FALSE(store.newest_finished());
}

TEST(ScanStore, ListsScansOfTheSameSecondInTheirOrder) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  for (int i = 0; i < 20; ++i) {
    const Job job = store.create({});
    EXPECT_EQ(store.list().front().id, job.id);
  }
  EXPECT_EQ(store.list().size(), 20U);
}

TEST(ScanStore, PutsANewScanFirstAlthoughTheClockHasGoneBack) {
  const TemporaryFolder folder;
  for (const char* const id : {"20991231-235959-c34e", "20991231-235959-c34f"}) {
    put(folder.path() / "scans" / id / "job.json", to_job_json(Job{.id = id}).dump());
  }
  ScanStore store(folder.path());
  const Job job = store.create({});
  EXPECT_EQ(job.id, "21000101-000000-0000");
  EXPECT_EQ(job.created, "2100-01-01T00:00:00Z");
}

TEST(ScanStore, CallsWhatADeadProcessLeftRunningInterruptedAndKeepsItsSnapshots) {
  const TemporaryFolder folder;
  std::string id;
  leave_behind(folder.path(), [&](ScanStore& store) {
    id = store.create({}).id;
    Scan scan{.sensor_name = "test", .clip = {.min = {0, 0, 0}, .max = {1, 1, 1}}};
    const DepthFrame frame{
        .width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
    for (int i = 0; i < 2; ++i) {
      scan.shots.push_back({.file = shot_file(i)});
      write_depth_png(store.folder(id) / shot_file(i), frame);
    }
    write_scan(store.folder(id), scan);
    put(store.folder(id) / ".Scan.stl.abcdef", "half a model");
    put(store.folder(id) / "snapshots" / ".002.png.abcdef", "half a snapshot");
    put(folder.path() / "scans" / ".new-20261121-081500-aaaa" / "x", "");
    put(folder.path() / "scans" / ".removed-20261121-081500-bbbb" / "x", "");
  });

  ScanStore store(folder.path());
  const auto job = store.find(id);
  ASSERT_TRUE(job);
  EXPECT_EQ(job->state, JobState::interrupted);
  EXPECT_EQ(job->snapshots_done, 2);
  EXPECT_EQ(job->failure->code, ErrorCode::interrupted);
  EXPECT_TRUE(fs::exists(store.folder(id) / "snapshots" / "001.png"));
  EXPECT_FALSE(fs::exists(store.folder(id) / ".Scan.stl.abcdef"));
  EXPECT_FALSE(fs::exists(store.folder(id) / "snapshots" / ".002.png.abcdef"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "scans"), {}), 1);
}

TEST(ScanStore, ListsAScanWhoseRecordIsDamagedAsFailed) {
  const TemporaryFolder folder;
  const Job job = ScanStore(folder.path()).create({});
  const fs::path record = folder.path() / "scans" / job.id / "job.json";
  const std::string whole = content_of(record);
  for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
    put(record, whole.substr(0, length));
    const std::vector<Job> jobs = ScanStore(folder.path()).list();
    ASSERT_EQ(jobs.size(), 1U);
    EXPECT_EQ(jobs[0].id, job.id);
    EXPECT_EQ(jobs[0].state, JobState::failed);
    EXPECT_EQ(jobs[0].failure->code, ErrorCode::job_malformed);
  }
}

TEST(ScanStore, ListsAScanWhoseRecordLacksAKeyAsFailed) {
  const TemporaryFolder folder;
  const Job job = ScanStore(folder.path()).create({});
  const fs::path file = folder.path() / "scans" / job.id / "job.json";
  const auto code_of = [&] {
    return to_string(ScanStore(folder.path()).get(job.id).failure->code);
  };
  for (const char* const key : {"id", "name", "state", "phase", "created", "snapshots_done",
                                "seconds_elapsed", "settings"}) {
    nlohmann::json record = to_job_json(job);
    record.erase(key);
    put(file, record.dump());
    EXPECT_EQ(code_of(), "job-malformed") << key;
    record[key] = nlohmann::json::array();
    put(file, record.dump());
    EXPECT_EQ(code_of(), "job-malformed") << key;
  }
}

TEST(ScanStore, RemovesAScanWithEverythingInIt) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  put(store.folder(job.id) / "snapshots" / "000.png", "x");
  store.remove(job.id);
  EXPECT_FALSE(store.find(job.id));
  EXPECT_TRUE(fs::is_empty(folder.path() / "scans"));
  EXPECT_EQ(code_thrown_by([&] { store.remove(job.id); }), "no-such-scan");
}

TEST(ScanStore, NamesAScan) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  store.rename(job.id, "Hase, groß");
  store.save(job);  // the worker knows nothing of the name
  EXPECT_EQ(store.find(job.id)->name, "Hase, groß");
}

TEST(ScanStore, TouchesNothingThatIsNoScan) {
  const TemporaryFolder folder;
  put(folder.path() / "secret" / "job.json", "{}");
  ScanStore store(folder.path());
  for (const char* const id : {"../secret", "..", "", "."}) {
    EXPECT_FALSE(store.find(id));
    EXPECT_EQ(code_thrown_by([&] { store.remove(id); }), "no-such-scan");
    EXPECT_EQ(code_thrown_by([&] { store.rename(id, "x"); }), "no-such-scan");
  }
  EXPECT_TRUE(fs::exists(folder.path() / "secret" / "job.json"));
}

TEST(ScanStore, RemembersWhereThePlatformStands) {
  const TemporaryFolder folder;
  leave_behind(folder.path(), [](ScanStore& store) {
    EXPECT_EQ(store.platform_angle_deg(), 0);
    store.save_platform_angle_deg(120.15);
  });
  EXPECT_EQ(ScanStore(folder.path()).platform_angle_deg(), 120.15);
}

TEST(ScanStore, TakesThePlatformToBeAtItsBeginningIfItCannotBeTold) {
  const TemporaryFolder folder;
  for (const char* const text : {"", "{", "[]", "{}", R"({"angle_deg": "far"})"}) {
    put(folder.path() / "platform.json", text);
    EXPECT_EQ(ScanStore(folder.path()).platform_angle_deg(), 0) << text;
  }
}

/// What cannot be read in place of a small file, each put there by a call.
struct Unreadable {
  const char* what;
  std::function<void(const fs::path& file)> put;
  ErrorCode code = ErrorCode::read_failed;
};

const std::vector<Unreadable>& unreadable_files() {
  static const std::vector<Unreadable> all{
      // Reading a process's own memory at 0 gives EIO, as a bad sector does.
      {"a bad sector", [](const fs::path& file) { fs::create_symlink("/proc/self/mem", file); }},
      {"a folder", [](const fs::path& file) { fs::create_directory(file); }},
      {"a FIFO", [](const fs::path& file) { ASSERT_EQ(::mkfifo(file.c_str(), 0644), 0); }},
      {"a loop of links", [](const fs::path& file) { fs::create_symlink(file, file); }},
      {"a huge file", [](const fs::path& file) { put(file, std::string(2U << 20U, ' ')); },
       ErrorCode::job_malformed}};
  return all;
}

TEST(ScanStore, ListsAScanWhoseRecordCannotBeReadAsFailedAndRemovesIt) {
  for (const Unreadable& unreadable : unreadable_files()) {
    SCOPED_TRACE(unreadable.what);
    const TemporaryFolder folder;
    std::string bad;
    std::string good;
    leave_behind(folder.path(), [&](ScanStore& store) {
      good = store.create({}).id;
      bad = store.create({}).id;
      fs::remove(store.folder(bad) / "job.json");
      unreadable.put(store.folder(bad) / "job.json");
    });
    ScanStore store(folder.path());
    const std::vector<Job> jobs = store.list();
    ASSERT_EQ(jobs.size(), 2U);
    EXPECT_EQ(jobs[0].id, bad);
    EXPECT_EQ(jobs[0].state, JobState::failed);
    EXPECT_EQ(jobs[0].failure->code, unreadable.code);
    EXPECT_EQ(jobs[1].id, good);
    EXPECT_EQ(jobs[1].state, JobState::interrupted);
    EXPECT_FALSE(store.newest_finished());
    store.remove(bad);
    EXPECT_EQ(store.list().size(), 1U);
  }
}

TEST(ScanStore, TakesAScanWhoseNameCannotBeReadAsUnnamed) {
  for (const Unreadable& unreadable : unreadable_files()) {
    SCOPED_TRACE(unreadable.what);
    const TemporaryFolder folder;
    leave_behind(folder.path(), [&](ScanStore& store) {
      unreadable.put(store.folder(store.create({}).id) / "name.txt");
    });
    ScanStore store(folder.path());
    ASSERT_EQ(store.list().size(), 1U);
    EXPECT_EQ(store.list()[0].state, JobState::interrupted);
    EXPECT_EQ(store.list()[0].name, "");
  }
}

TEST(ScanStore, StartsWithAPlatformFileThatCannotBeRead) {
  for (const Unreadable& unreadable : unreadable_files()) {
    SCOPED_TRACE(unreadable.what);
    const TemporaryFolder folder;
    unreadable.put(folder.path() / "platform.json");
    EXPECT_EQ(ScanStore(folder.path()).platform_angle_deg(), 0);
  }
}

TEST(ScanStore, CountsNoSnapshotsWhereScanJsonCannotBeRead) {
  for (const Unreadable& unreadable : unreadable_files()) {
    SCOPED_TRACE(unreadable.what);
    const TemporaryFolder folder;
    leave_behind(folder.path(), [&](ScanStore& store) {
      unreadable.put(store.folder(store.create({}).id) / "scan.json");
    });
    ScanStore store(folder.path());
    EXPECT_EQ(store.list().at(0).state, JobState::interrupted);
    EXPECT_EQ(store.list().at(0).snapshots_done, 0);
  }
}

TEST(ScanStore, RecoversAndSavesTextThatIsNoUtf8) {
  const TemporaryFolder folder;
  leave_behind(folder.path(), [&](ScanStore& store) {
    put(store.folder(store.create({}).id) / "name.txt", "abc\xff");
  });
  ScanStore store(folder.path());
  Job job = store.list().at(0);
  EXPECT_EQ(job.state, JobState::interrupted);
  job.state = JobState::failed;
  job.failure = Failure{.code = ErrorCode::sensor_failed, .detail = "no such sensor: rec\xff\xc3"};
  store.save(job);
  EXPECT_EQ(store.find(job.id)->state, JobState::failed);
  EXPECT_TRUE(store.find(job.id)->failure->detail.starts_with("no such sensor: rec"));
}

TEST(ScanStore, ReadsADataFolderOfVersion01) {
  const TemporaryFolder folder;
  fs::copy(fs::path(OCTURN_GOLDEN) / "data-0.1", folder.path(), fs::copy_options::recursive);
  const ScanStore store(folder.path());
  ASSERT_EQ(store.list().size(), 2U);
  const Job paused = store.get("20261122-220500-0a1b");
  EXPECT_EQ(paused.state, JobState::paused);
  EXPECT_EQ(paused.snapshots_done, 2);
  EXPECT_EQ(paused.failure->code, ErrorCode::sensor_missing);
  const Job finished = store.get("20261122-215909-48de");
  EXPECT_EQ(finished.state, JobState::finished);
  EXPECT_EQ(finished.name, "Hase, groß");
  EXPECT_EQ(finished.created, "2026-11-22T21:59:09Z");
  EXPECT_EQ(finished.settings.snapshots, 3);
  EXPECT_EQ(finished.settings.frames, 2);
  EXPECT_NEAR(finished.settings.leaf_size, 0.004, 1e-12);
  EXPECT_EQ(finished.model->report.bytes, 298584U);
  EXPECT_EQ(finished.model->report.triangles, 5970U);
  EXPECT_TRUE(finished.model->report.watertight);
  EXPECT_NEAR(finished.model->report.volume, 270.461e-6, 1e-12);
  EXPECT_EQ(store.newest_finished()->id, finished.id);
}

TEST(ScanStore, WritesNoAddressOfTheApi) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  Job job = store.create({});
  job.state = JobState::finished;
  job.model = Model{};
  store.save(job);
  const std::string record = content_of(store.folder(job.id) / "job.json");
  EXPECT_EQ(record.find("/api/"), std::string::npos) << record;
}

TEST(ScanStore, ListsAndFindsWithoutTheDisk) {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  ScanStore store(folder.path());
  Job job = store.create({});
  job.state = JobState::finished;
  job.model = Model{};
  store.save(job);
  fs::rename(folder.path() / "scans", elsewhere.path() / "scans");
  EXPECT_EQ(store.list().size(), 1U);
  EXPECT_EQ(store.find(job.id)->state, JobState::finished);
  EXPECT_EQ(store.newest_finished()->id, job.id);
  fs::rename(elsewhere.path() / "scans", folder.path() / "scans");
}

TEST(ScanStore, RemovesAScanWhoseFolderIsGone) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  fs::remove_all(store.folder(job.id));
  EXPECT_EQ(code_thrown_by([&] { store.save(job); }), "write-failed");
  store.remove(job.id);
  EXPECT_TRUE(store.list().empty());
}

TEST(ScanStore, TakesAScanAsInterruptedThatCouldNotBeSaved) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  const Job interrupted = store.interrupt(job.id);
  EXPECT_EQ(interrupted.state, JobState::interrupted);
  EXPECT_EQ(store.find(job.id)->failure->code, ErrorCode::interrupted);
  EXPECT_EQ(code_thrown_by([&] { store.interrupt("20261121-081500-aaaa"); }), "no-such-scan");
}

TEST(ScanStore, BelongsToOneProcessAtATime) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  EXPECT_EQ(code_thrown_by([&] { ScanStore(folder.path()); }), "data-in-use");
}

TEST(ScanStore, SaysWhereItCannotWrite) {
  const TemporaryFolder folder;
  put(folder.path() / "file", "");
  EXPECT_EQ(code_thrown_by([&] { ScanStore(folder.path() / "file"); }), "data-failed");
}

TEST(ScanStore, RefusesAScanThatMayNotFit) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  ScanSettings settings;
  settings.snapshots = 2'000'000'000;  // more than any disk takes
  const Error error = error_thrown_by([&] { store.create(settings); });
  EXPECT_EQ(error.code(), ErrorCode::disk_full);
  EXPECT_FALSE(error.hint().empty());
  EXPECT_TRUE(store.list().empty());
}

}  // namespace
}  // namespace octurn
