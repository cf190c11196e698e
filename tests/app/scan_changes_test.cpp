// Changes of a stored scan while its worker has a copy of it.

#include <nlohmann/json.hpp>

#include "app/leave_behind.hpp"
#include "app/scanner_fixture.hpp"
#include "store/job_file.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

void add_build(ScanStore& store, const std::string& id, int number) {
  put(store.begin_build(id, number), "a model");
  store.add_build(id, {.number = number});
}

std::vector<int> build_numbers(const Job& job) {
  std::vector<int> numbers;
  for (const Build& build : job.builds.all) {
    numbers.push_back(build.number);
  }
  return numbers;
}

TEST(ScanStore, KeepsTheChangesOfBuildsThatAWorkersCopyDoesNotHave) {
  const TemporaryFolder folder;
  std::string id;
  leave_behind(folder.path(), [&](ScanStore& store) {
    id = store.create({}).id;
    add_build(store, id, 1);
    add_build(store, id, 2);
    Job copy = store.get(id);
    store.remove_build(id, 1);
    store.choose_build(id, 2);
    add_build(store, id, 3);
    copy.snapshots_done = 7;
    copy.builds.have_colours = true;
    copy.state = JobState::cancelled;
    store.save(copy);
    const Job now = store.get(id);
    EXPECT_EQ(build_numbers(now), (std::vector{2, 3}));
    EXPECT_EQ(now.builds.chosen, 2);
    EXPECT_EQ(now.snapshots_done, 7);
    EXPECT_TRUE(now.builds.have_colours);
  });
  const Job read = ScanStore(folder.path()).get(id);
  EXPECT_EQ(build_numbers(read), (std::vector{2, 3}));
  EXPECT_EQ(read.builds.chosen, 2);
  EXPECT_EQ(read.snapshots_done, 7);
}

TEST(ScanStore, UpdatesAScanAsItIsStored) {
  const TemporaryFolder folder;
  std::string id;
  leave_behind(folder.path(), [&](ScanStore& store) {
    id = store.create({}).id;
    add_build(store, id, 1);
    const std::uint64_t before = store.revision();
    const Job updated = store.update(id, [](Job& stored) {
      EXPECT_EQ(build_numbers(stored), std::vector{1});
      stored.builds.chosen = 1;
      stored.state = JobState::finished;
    });
    EXPECT_EQ(to_job_json(updated), to_job_json(store.get(id)));
    EXPECT_NE(store.revision(), before);
    EXPECT_THROW(store.update(id,
                              [](Job& stored) {
                                stored.state = JobState::failed;
                                throw std::runtime_error("no");
                              }),
                 std::runtime_error);
    EXPECT_EQ(store.get(id).state, JobState::finished);
    EXPECT_EQ(code_thrown_by([&] { store.update("20000101-000000-0000", [](Job&) {}); }),
              "no-such-scan");
  });
  const Job read = ScanStore(folder.path()).get(id);
  EXPECT_EQ(read.state, JobState::finished);
  EXPECT_EQ(read.builds.chosen, 1);
}

using ScanChangesTest = ScannerTest;

TEST_F(ScanChangesTest, ShowWhileTheScanRunsAndAfterItsEnd) {
  Scanner scanner(rig(), {}, store_);
  const std::string id = scanner.start(few_snapshots(6))->id;
  wait_until(scanner, [](const Status& status) { return status.job->snapshots_done >= 2; });
  scanner.cancel(id);
  ASSERT_EQ(scanner.wait_until_done(patience).job->state, JobState::cancelled);
  add_build(store_, id, 1);
  add_build(store_, id, 2);
  ASSERT_TRUE(scanner.resume(id));
  scanner.remove_build(id, 1);
  scanner.choose_build(id, 2);
  for (const Job& shown : {scanner.find(id), scanner.list().at(0)}) {
    EXPECT_EQ(build_numbers(shown), std::vector{2});
    EXPECT_EQ(shown.builds.chosen, 2);
  }
  ASSERT_EQ(scanner.wait_until_done(patience).job->state, JobState::finished);
  EXPECT_EQ(build_numbers(scanner.find(id)), std::vector{2});
  EXPECT_EQ(scanner.find(id).builds.chosen, 2);
}

}  // namespace
}  // namespace octurn
