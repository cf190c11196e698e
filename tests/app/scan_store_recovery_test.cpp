#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "app/leave_behind.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "store/job_file.hpp"
#include "store/scan_store.hpp"
#include "store/stored_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

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

TEST(ScanStore, ClearsAwayWhatADeadProcessWasWritingBesideTheScansAndNothingElse) {
  const TemporaryFolder folder;
  const fs::path data = folder.path();
  put(data / ".platform.json.1234-0", "half a file");
  put(data / ".settings.json.99-12", "");
  put(data / ".somebodys.json.swp", "");
  put(data / ".profile", "");
  const ScanStore store(data);
  EXPECT_FALSE(fs::exists(data / ".platform.json.1234-0"));
  EXPECT_FALSE(fs::exists(data / ".settings.json.99-12"));
  EXPECT_TRUE(fs::exists(data / ".somebodys.json.swp"));
  EXPECT_TRUE(fs::exists(data / ".profile"));
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

// Earlier versions did not write "has_views"; only scans by laser line are in colour.
TEST(ScanStore, OffersViewsOfEarlierScansThatHaveThem) {
  const TemporaryFolder folder;
  const Job job = ScanStore(folder.path()).create({});
  nlohmann::json record = to_job_json(job);
  record.erase("has_views");
  for (const bool is_by_laser : {false, true}) {
    record["has_colours"] = is_by_laser;
    put(folder.path() / "scans" / job.id / "job.json", record.dump());
    EXPECT_EQ(ScanStore(folder.path()).get(job.id).builds.have_views, !is_by_laser);
  }
}

TEST(ScanStore, OffersNoViewsOfEarlierScansByLaserInGrey) {
  const TemporaryFolder folder;
  const Job job = ScanStore(folder.path()).create({});
  const fs::path of_job = folder.path() / "scans" / job.id;
  nlohmann::json record = to_job_json(job);
  record.erase("has_views");
  put(of_job / "job.json", record.dump());
  Scan scan{.sensor_name = "test", .clip = {.min = {0, 0, 0}, .max = {1, 1, 1}}};
  scan.shots.push_back({.file = shot_file(0)});
  write_scan(of_job, scan);
  EXPECT_TRUE(ScanStore(folder.path()).get(job.id).builds.have_views);
  const Laser laser{.name = "left", .normal = Eigen::Vector3d::UnitX(), .distance = 0.1};
  scan.laser = LaserCamera{.lasers = {laser}};
  scan.shots = {{.pictures = picture_files(0, *scan.laser)}};
  write_scan(of_job, scan);
  put(of_job / "job.json", record.dump());
  EXPECT_FALSE(ScanStore(folder.path()).get(job.id).builds.have_views);
}

TEST(ScanStore, TakesThePlatformToBeAtItsBeginningIfItCannotBeTold) {
  const TemporaryFolder folder;
  for (const char* const text : {"", "{", "[]", "{}", R"({"angle_deg": "far"})"}) {
    put(folder.path() / "platform.json", text);
    EXPECT_EQ(ScanStore(folder.path()).platform_angle_deg(), 0) << text;
  }
}

/// Something unreadable in place of a small file, and a function that puts it there.
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
    store.discard(bad);
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
    EXPECT_EQ(store.list()[0].label.name, "");
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

TEST(ScanStore, TakesAScanAsInterruptedThatCouldNotBeSaved) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  const Job interrupted = store.interrupt(job.id, interruption());
  EXPECT_EQ(interrupted.state, JobState::interrupted);
  EXPECT_EQ(store.find(job.id)->failure->code, ErrorCode::interrupted);
  EXPECT_EQ(code_thrown_by([&] { store.interrupt("20261121-081500-aaaa", interruption()); }),
            "no-such-scan");
}

}  // namespace
}  // namespace octurn
