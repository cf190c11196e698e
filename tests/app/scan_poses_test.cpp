// Further poses of a scan's object, each with a scan of its own.

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/scanner_fixture.hpp"
#include "build/merged_scan.hpp"
#include "octurn/file.hpp"
#include "octurn/scan_folder.hpp"
#include "store/builds.hpp"
#include "store/pose_choice.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Settings with the told sensor pose, so that nothing is solved.
ScanSettings quick(int snapshots = 3) {
  ScanSettings settings = few_snapshots(snapshots);
  settings.pose = PoseSource::configured;
  return settings;
}

class ScanPosesTest : public ScannerTest {
 protected:
  /// The model of a scan, as a client gets it.
  std::string model_of(const std::string& id) const { return content_of(store_.model_file(id)); }

  /// Registers the first further pose again by a choice. @return the build when it has ended
  static BuildRun choose(Scanner& scanner, const std::string& first, const PoseChoice& choice) {
    EXPECT_TRUE(scanner.choose_pose(first, 1, choice));
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!(**scanner.build_run()).has_ended() && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return **scanner.build_run();
  }

  /// Expects that a choice near the true pose finds it again, and that one far off is refused and
  /// changes nothing.
  void choose_again(Scanner& scanner, const Job& pose) const {
    const std::string& first = pose.pose_of->scan;
    const Eigen::Isometry3d& found = pose.pose_of->registration->pose.object_from_platform;
    const BuildRun refused =
        choose(scanner, first,
               {.pose = pose.id, .object_from_platform = Eigen::Translation3d(0.5, 0, 0) * found});
    EXPECT_EQ(refused.state, BuildRun::State::failed);
    ASSERT_EQ(store_.get(first).builds.all.size(), 1U);
    const Eigen::Isometry3d near = Eigen::Translation3d(0.003, 0, -0.002) * found;
    const BuildRun run = choose(scanner, first, {.pose = pose.id, .object_from_platform = near});
    ASSERT_EQ(run.state, BuildRun::State::finished) << run.failure->detail;
    const Job job = store_.get(first);
    ASSERT_EQ(job.builds.all.size(), 1U) << "the one before it goes";
    EXPECT_EQ(job.builds.chosen, run.number);
    EXPECT_EQ(job.builds.all.front().replaced, 0);
    EXPECT_EQ(job.builds.all.front().poses, std::vector{pose.id});
    const auto kept = store_.get(pose.id).pose_of->registration;
    EXPECT_LT((kept->pose.object_from_platform.translation() - found.translation()).norm(), 0.002);
    EXPECT_FALSE(kept->candidate);
    EXPECT_EQ(kept->candidates.size(), pose.pose_of->registration->candidates.size());
  }

  /// A scan whose model is built together with another pose.
  Job merged(const std::string& pose) {
    Job job = store_.create(quick());
    job.state = JobState::finished;
    job.model = Model{};
    store_.save(job);
    write_file(store_.folder(job.id) / "Scan.stl", "alone");
    for (const auto& poses : {std::vector<std::string>{}, std::vector<std::string>{pose}}) {
      const int number = store_.next_build(job.id);
      const fs::path file = store_.begin_build(job.id, number);
      write_file(file, poses.empty() ? "finer" : "both sides");
      if (!poses.empty()) {
        fs::create_directory(file.parent_path() / merged_folder);
      }
      Build build;
      build.number = number;
      build.poses = poses;
      build.replaced = store_.get(job.id).builds.chosen;
      store_.add_build(job.id, build);
      store_.choose_build(job.id, number);
    }
    return store_.get(job.id);
  }
};

TEST_F(ScanPosesTest, LeaveTheFirstScanAsItWasWhenTheyAreCancelled) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  const Job first = scan(scanner, quick());
  const std::string model = model_of(first.id);
  gate_.hold(scanner, 1);
  const auto pose = scanner.start_pose(first.id, quick());
  ASSERT_TRUE(pose);
  EXPECT_FALSE(scanner.start_pose(first.id, quick())) << "while one is scanned";
  EXPECT_THROW(scanner.remove_pose(first.id, 1), Error);
  wait_for_snapshots(scanner, 1);
  EXPECT_TRUE(scanner.cancel(pose->id));
  scanner.wait_until_done(patience);
  ASSERT_EQ(scanner.poses(first.id).size(), 1U);
  EXPECT_EQ(scanner.poses(first.id).front().state, JobState::cancelled);
  EXPECT_EQ(store_.get(first.id).state, JobState::finished);
  EXPECT_TRUE(model_of(first.id) == model);
  EXPECT_EQ(store_.newest_finished()->id, first.id);
  scanner.remove_pose(first.id, 1);
  EXPECT_TRUE(scanner.poses(first.id).empty());
  EXPECT_FALSE(store_.find(pose->id));
}

TEST_F(ScanPosesTest, GoOnAfterTheProgramEndedAndAreMergedAndTakenBack) {
  std::string first;
  std::string pose;
  {
    Scanner scanner(gate_.before(rig()), {}, store_);
    first = scan(scanner, quick(6)).id;
    gate_.hold(scanner, 1);
    pose = scanner.start_pose(first, quick(6))->id;
    wait_for_snapshots(scanner, 1);
  }
  const std::string model = model_of(first);
  EXPECT_EQ(store_.get(pose).state, JobState::interrupted);
  EXPECT_EQ(store_.get(first).state, JobState::finished);
  Scanner scanner(rig(), {}, store_);
  ASSERT_TRUE(scanner.resume(pose));
  scanner.wait_until_done(patience);
  const Job job = store_.get(pose);
  EXPECT_EQ(job.state, JobState::finished);
  ASSERT_TRUE(job.pose_of && job.pose_of->registration);
  ASSERT_TRUE(job.pose_of->registration->accepted) << job.pose_of->registration->reason;
  EXPECT_FALSE(model_of(first) == model);
  EXPECT_EQ(read_scan(store_.merged_scan(first, {pose})).shots.size(), 12U);
  EXPECT_EQ(job.pose_of->registration->candidate, 0U);
  EXPECT_TRUE(fs::exists(store_.folder(pose) / pose_points_file));
  choose_again(scanner, job);
  const std::string merged = model_of(first);
  scanner.remove_pose(first, 1);
  EXPECT_TRUE(model_of(first) == model);
  EXPECT_TRUE(store_.get(first).builds.all.empty());
  EXPECT_EQ(store_.bin().list().size(), 1U);
  scanner.restore(pose);
  EXPECT_TRUE(model_of(first) == merged);
  EXPECT_EQ(scanner.poses(first).size(), 1U);
  EXPECT_TRUE(store_.get(pose).pose_of->registration->accepted);
  EXPECT_EQ(read_scan(store_.merged_scan(first, {pose})).shots.size(), 12U);
}

TEST_F(ScanPosesTest, AreJoinedWithThoseBeforeThem) {
  Scanner scanner(rig(), {}, store_);
  const std::string first = scan(scanner, quick(6)).id;
  std::vector<std::string> poses;
  std::vector<std::string> models;
  for (int i = 0; i < 2; ++i) {
    poses.push_back(scanner.start_pose(first, quick(6))->id);
    scanner.wait_until_done(patience);
    const auto found = store_.get(poses.back()).pose_of->registration;
    ASSERT_TRUE(found && found->accepted) << (found ? found->reason : "no answer");
    EXPECT_EQ(read_scan(store_.merged_scan(first, poses)).poses.size(), poses.size() + 1);
    EXPECT_EQ(store_.get(first).builds.all.back().poses, poses);
    models.push_back(model_of(first));
  }
  EXPECT_FALSE(models[0] == models[1]);
  scanner.remove_pose(first, 2);
  EXPECT_TRUE(model_of(first) == models[0]);
}

TEST_F(ScanPosesTest, LeaveTheFirstScanAsItWasWhenTheyDoNotFit) {
  Scanner scanner(rig(), {}, store_);
  const std::string first = scan(scanner, quick()).id;
  const std::string model = model_of(first);
  ScanSettings little = quick();
  little.clip = {.min = {-0.02, -0.02, 0.02}, .max = {0.02, 0.02, 0.05}};
  const std::string pose = scanner.start_pose(first, little)->id;
  scanner.wait_until_done(patience);
  const Job job = store_.get(pose);
  EXPECT_EQ(job.state, JobState::finished);
  ASSERT_TRUE(job.pose_of && job.pose_of->registration);
  EXPECT_FALSE(job.pose_of->registration->accepted);
  EXPECT_NE(job.pose_of->registration->reason, "");
  EXPECT_TRUE(model_of(first) == model);
  EXPECT_TRUE(store_.get(first).builds.all.empty());
}

TEST_F(ScanPosesTest, AreOfFinishedScansThatAreNoPosesThemselves) {
  Scanner scanner(rig(), {}, store_);
  Job unfinished = store_.create(quick());
  EXPECT_THROW(scanner.start_pose(unfinished.id, quick()), Error);
  unfinished.state = JobState::finished;
  store_.save(unfinished);
  Job pose = store_.create(quick(), PoseOf{.scan = unfinished.id});
  pose.state = JobState::finished;
  store_.save(pose);
  EXPECT_THROW(scanner.start_pose(pose.id, quick()), Error);
}

TEST_F(ScanPosesTest, AreTakenBackToTheModelBeforeThem) {
  Scanner scanner(rig(), {}, store_);
  const Job first = merged("20260102-030405-0000");
  EXPECT_EQ(model_of(first.id), "both sides");
  EXPECT_THROW(scanner.remove_build(first.id, 2), Error) << "it belongs to the pose";
  store_.withdraw_pose(first.id, "20260102-030405-0000");
  EXPECT_EQ(model_of(first.id), "finer");
  EXPECT_EQ(store_.get(first.id).builds.all.size(), 1U);
}

TEST_F(ScanPosesTest, AreKeptWithWhatTheyFitTo) {
  const TemporaryFolder data;
  std::string pose;
  {
    ScanStore store(data.path());
    const Job first = store.create(quick());
    Job job = store.create(quick(), PoseOf{.scan = first.id});
    job.state = JobState::finished;
    job.pose_of->registration =
        PoseRegistration{.accepted = true,
                         .pose = {.overlap = 0.5, .residual = 0.0004},
                         .candidates = {{.overlap = 0.5}, {.overlap = 0.4, .contradiction = 0.7}},
                         .candidate = 1};
    store.save(job);
    pose = job.id;
  }
  const ScanStore store(data.path());
  const Job job = store.get(pose);
  ASSERT_TRUE(job.pose_of && job.pose_of->registration);
  EXPECT_TRUE(job.pose_of->registration->accepted);
  EXPECT_NEAR(job.pose_of->registration->pose.overlap, 0.5, 1e-12);
  EXPECT_NEAR(job.pose_of->registration->pose.residual, 0.0004, 1e-12);
  ASSERT_EQ(job.pose_of->registration->candidates.size(), 2U);
  EXPECT_NEAR(job.pose_of->registration->candidates[1].contradiction, 0.7, 1e-12);
  EXPECT_EQ(job.pose_of->registration->candidate, 1U);
  EXPECT_EQ(store.poses(job.pose_of->scan).size(), 1U);
}

TEST(PoseChoice, IsACandidateOrPairsOfPoints) {
  const Job pose{.pose_of = PoseOf{.registration = PoseRegistration{.candidates = {{}, {}}}}};
  EXPECT_EQ(pose_choice_from({{"candidate", 1}}, pose).candidate, 1U);
  const auto pairs =
      nlohmann::json::parse("[[[10,0,0],[0,10,5]], [[0,20,0],[-20,0,5]], [[-30,0,0],[0,-30,5]]]");
  const PoseChoice choice = pose_choice_from({{"pairs_mm", pairs}}, pose);
  EXPECT_FALSE(choice.candidate);
  // A quarter turn about Z, and 5 mm down.
  EXPECT_LT(
      (choice.object_from_platform * Eigen::Vector3d(0, 0.01, 0.005) - Eigen::Vector3d(0.01, 0, 0))
          .norm(),
      1e-9);
}

TEST(PoseChoice, RefusesWhatIsNone) {
  const Job pose{.pose_of = PoseOf{.registration = PoseRegistration{.candidates = {{}, {}}}}};
  for (const char* const body :
       {"{}", R"({"candidate": 2})", R"({"candidate": -1})", R"({"candidate": 0, "pairs_mm": []})",
        R"({"pairs_mm": []})", R"({"pairs_mm": [[[0,0,0],[0,0,0]]]})", R"({"other": 1})",
        R"({"pairs_mm": [[[0,0,0],[0,0,0]], [[9,0,0],[9,0,0]], [[20,0,0],[20,0,0]]]})"}) {
    EXPECT_THROW(pose_choice_from(nlohmann::json::parse(body), pose), Error) << body;
  }
  EXPECT_THROW(pose_choice_from({{"candidate", 0}}, Job{.pose_of = PoseOf{}}), Error);
}

}  // namespace
}  // namespace octurn
