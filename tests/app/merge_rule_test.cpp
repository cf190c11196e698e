// The page and the shell merge two scans by one rule.

#include "app/scanner_fixture.hpp"
#include "build/merged_scan.hpp"
#include "octurn/scan_folder.hpp"
#include "support/wrong_pose.hpp"

namespace octurn {
namespace {

using MergeRuleTest = ScannerTest;

/// Settings with a wrong configured pose, which the scans themselves do not solve.
ScanSettings unsolved() {
  ScanSettings settings = few_snapshots(12);
  settings.platform_from_sensor = wrong_pose();
  settings.pose = PoseSource::configured;
  return settings;
}

/// Merges as `octurn merge` does, which takes the process's signals and so cannot run here.
/// @return the merged scan.json
std::string merged_by_the_shell(const std::filesystem::path& first,
                                const std::filesystem::path& pose) {
  const TemporaryFolder folder;
  const std::filesystem::path output = folder.path() / "merged";
  std::vector<StoredTurn> turns = read_turns({first, pose});
  const Registration registration = register_turns(turns, 1, {});
  EXPECT_TRUE(registration.accepted) << registration.reason;
  write_merged_scan(output, turns, registration);
  return content_of(output / "scan.json");
}

TEST_F(MergeRuleTest, IsOneForPageAndShell) {
  Scanner scanner(rig(), {}, store_);
  const std::string first = scan(scanner, unsolved()).id;
  const std::string pose = scanner.start_pose(first, unsolved())->id;
  scanner.wait_until_done(patience);
  const auto found = store_.get(pose).pose_of->registration;
  ASSERT_TRUE(found && found->accepted) << (found ? found->reason : "no answer");
  EXPECT_FALSE(read_scan(store_.folder(first)).solved);

  const std::filesystem::path by_the_page = store_.merged_scan(first, {pose});
  const Scan merged = read_scan(by_the_page);
  ASSERT_EQ(merged.poses.size(), 2U);
  ASSERT_TRUE(merged.poses[0].solved && merged.poses[1].solved);
  const std::string by_the_shell = merged_by_the_shell(store_.folder(first), store_.folder(pose));
  EXPECT_EQ(content_of(by_the_page / "scan.json"), by_the_shell);

  ASSERT_TRUE(scanner.choose_pose(
      first, 1,
      {.pose = pose, .object_from_platform = found->pose.object_from_platform, .candidate = 0}));
  scanner.wait_until_done(patience);
  const Scan again = read_scan(store_.merged_scan(first, {pose}));
  ASSERT_TRUE(again.poses[1].solved);
  EXPECT_EQ(again.poses[1].solved->platform_from_sensor.matrix(),
            merged.poses[1].solved->platform_from_sensor.matrix());
}

}  // namespace
}  // namespace octurn
