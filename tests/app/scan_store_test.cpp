#include "store/scan_store.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/leave_behind.hpp"
#include "store/job_file.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

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
  job.times.elapsed = std::chrono::milliseconds(12345);
  job.model = Model{.report = {.leaves = 11,
                               .triangles = 22,
                               .bytes = 1184,
                               .watertight = true,
                               .volume = 0.000123,
                               .size = {0.12, 0.095, 0.151}},
                    .build_time = std::chrono::milliseconds(80)};
  job.calibration =
      ScanCalibration{.accepted = true,
                      .solved = SolvedPose{.platform_from_sensor = nominal_platform_from_sensor(),
                                           .position_sigma = 0.00004,
                                           .direction_sigma = 0.0002,
                                           .before = 0.0021,
                                           .after = 0.0005},
                      .findings = {{.code = "slip",
                                    .detail = "stop 3",
                                    .hint = "Look.",
                                    .stop = 3,
                                    .angle = 0.03,
                                    .parameters = {{"stop", 3.0}, {"off_deg", 1.7}}}},
                      .rebuilt = 36};
  store.save(job);
  const auto found = store.find(job.id);
  ASSERT_TRUE(found && found->model);
  EXPECT_EQ(to_job_json(*found), to_job_json(job));
  ASSERT_EQ(found->calibration->findings.size(), 1U);
  EXPECT_EQ(found->calibration->findings[0].parameters,
            (Parameters{{"stop", 3.0}, {"off_deg", 1.7}}));
  EXPECT_NEAR(found->model->report.volume, 0.000123, 1e-12);
  EXPECT_EQ(store.newest_finished()->id, job.id);
}

TEST(ScanStore, ListsTheNewestFirst) {
  const TemporaryFolder folder;
  for (const char* const id :
       {"20261121-081500-aaaa", "20251231-235959-ffff", "20270101-000000-0000"}) {
    Job job{.id = id, .times = {.created = "2026-11-21T08:15:00Z"}};
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
  EXPECT_EQ(job.times.created, "2100-01-01T00:00:00Z");
}

TEST(ScanStore, RemovesAScanWithEverythingInIt) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  const Job job = store.create({});
  put(store.folder(job.id) / "snapshots" / "000.png", "x");
  store.discard(job.id);
  store.empty_bin();
  EXPECT_FALSE(store.find(job.id));
  EXPECT_TRUE(fs::is_empty(folder.path() / "scans"));
  EXPECT_TRUE(fs::is_empty(folder.path() / "bin"));
  EXPECT_EQ(code_thrown_by([&] { store.discard(job.id); }), "no-such-scan");
}

TEST(ScanStore, KeepsWhatAPersonWroteOnAScan) {
  const TemporaryFolder folder;
  std::string id;
  const auto expect_label = [&](const ScanStore& store) {
    const ScanLabel label = store.get(id).label;
    EXPECT_EQ(label.name, "Hase, groß");
    EXPECT_EQ(label.notes, "Plaster, 1920.\nThe left ear is glued.");
    EXPECT_EQ(label.tags, "Grave 3\nplaster\n");
    EXPECT_EQ(label.inventory_number, "2026.17.3");
    EXPECT_EQ(label.author, "Jane Doe");
    EXPECT_EQ(label.licence, "CC BY 4.0");
  };
  {
    ScanStore store(folder.path());
    const Job job = store.create({}, {}, {.author = "Jane Doe", .licence = "CC BY 4.0"});
    id = job.id;
    EXPECT_EQ(job.label.author, "Jane Doe");
    store.label(id, {.name = "Hase, groß", .inventory_number = "2026.17.3"});
    store.label(id,
                {.notes = "Plaster, 1920.\nThe left ear is glued.", .tags = "Grave 3\nplaster\n"});
    store.save(Job{.id = id});  // the worker's copy has none of them
    expect_label(store);
  }
  expect_label(ScanStore(folder.path()));
}

/// Whether a label may have that text.
bool is_valid(std::string_view key, const std::string& text) {
  return std::ranges::find(label_texts(), key, &LabelText::key)->is_valid(text);
}

TEST(ScanLabel, HasANameOfOneLineAndNotesOfSeveral) {
  EXPECT_TRUE(is_valid("name", ""));
  EXPECT_TRUE(is_valid("notes", "a\n\tb"));
  EXPECT_FALSE(is_valid("name", "a\nb"));
  EXPECT_FALSE(is_valid("notes", "a\x1b[31m"));
  std::string umlauts;
  for (int i = 0; i < 2000; ++i) {
    EXPECT_EQ(is_valid("name", umlauts), i <= 100) << i;
    umlauts += "ä";
  }
  EXPECT_TRUE(is_valid("notes", umlauts));
  EXPECT_FALSE(is_valid("notes", umlauts + "ä"));
}

TEST(ScanLabel, HasFewDifferentTagsThatAListSeparatedByCommasCanShow) {
  EXPECT_TRUE(is_valid("tags", ""));
  EXPECT_TRUE(is_valid("tags", "Grab 3\nGefäß\n"));
  EXPECT_FALSE(is_valid("tags", "a\na\n"));
  EXPECT_FALSE(is_valid("tags", "a\n\nb\n"));
  EXPECT_FALSE(is_valid("tags", "a, b\n"));
  EXPECT_FALSE(is_valid("tags", "a\tb\n"));
  EXPECT_TRUE(is_valid("tags", std::string(40, 'x') + "\n"));
  EXPECT_FALSE(is_valid("tags", std::string(41, 'x') + "\n"));
  std::string tags;
  for (int i = 1; i <= 21; ++i) {
    tags += std::to_string(i) + "\n";
    EXPECT_EQ(is_valid("tags", tags), i <= 20) << i;
  }
}

TEST(ScanStore, HasAnotherRevisionAfterEveryChangeThatAListShows) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  std::uint64_t last = store.revision();
  const auto expect_change = [&](const char* what) {
    EXPECT_NE(store.revision(), last) << what;
    last = store.revision();
  };
  Job job = store.create({});
  expect_change("created");
  job.snapshots_done = 1;
  store.save(job);
  EXPECT_EQ(store.revision(), last) << "of a scan that runs the status tells";
  job.state = JobState::finished;
  store.save(job);
  expect_change("finished");
  store.label(job.id, {.name = "Hase"});
  expect_change("named");
  store.label(job.id, {.notes = "of clay"});
  expect_change("noted");
  store.discard(job.id);
  expect_change("removed");
}

TEST(ScanStore, TouchesNothingThatIsNoScan) {
  const TemporaryFolder folder;
  put(folder.path() / "secret" / "job.json", "{}");
  ScanStore store(folder.path());
  for (const char* const id : {"../secret", "..", "", "."}) {
    EXPECT_FALSE(store.find(id));
    EXPECT_EQ(code_thrown_by([&] { store.discard(id); }), "no-such-scan");
    EXPECT_EQ(code_thrown_by([&] { store.label(id, {.name = "x"}); }), "no-such-scan");
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
  EXPECT_EQ(finished.label.name, "Hase, groß");
  EXPECT_EQ(finished.times.created, "2026-11-22T21:59:09Z");
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
  store.discard(job.id);
  EXPECT_TRUE(store.list().empty());
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
  settings.snapshots = 2'000'000'000;  // more than fit on any disk
  const Error error = error_thrown_by([&] { store.create(settings); });
  EXPECT_EQ(error.code(), ErrorCode::disk_full);
  EXPECT_FALSE(error.hint().empty());
  ASSERT_EQ(error.parameters().size(), 3U);
  EXPECT_EQ(error.parameters().at("path"), Parameters::mapped_type(folder.path().string()));
  const std::string needed =
      std::to_string(std::llround(std::get<double>(error.parameters().at("needed_mb"))));
  EXPECT_NE(std::string(error.what()).find("needs " + needed + " MB"), std::string::npos)
      << error.what();
  EXPECT_LT(std::get<double>(error.parameters().at("free_mb")),
            std::get<double>(error.parameters().at("needed_mb")));
  EXPECT_TRUE(store.list().empty());
}

}  // namespace
}  // namespace octurn
