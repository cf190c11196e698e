#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "support/ball_scan.hpp"
#include "support/checksum.hpp"
#include "support/daemon.hpp"
#include "support/program.hpp"
#include "support/room_scan.hpp"
#include "support/small_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/upload.hpp"

// `octurn reconstruct --memory-limit-mb N` keeps its limit: it works although the kernel gives it
// no more memory, and its peak resident memory is lower.

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t mb = std::size_t{1} << 20U;

std::vector<std::string> command(const fs::path& scan, const std::string& leaf_size_mm,
                                 std::vector<std::string> more = {},
                                 const std::string& method = "intersection") {
  std::vector<std::string> words{octurn_program(), "reconstruct", scan.string(), "-o",  "-",
                                 "--leaf-size-mm", leaf_size_mm,  "--method",    method};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

struct Outcome {
  int status = 0;
  std::string errors = {};
  std::size_t peak_bytes = 0;
  Checksum model = {};
};

Outcome outcome_of(const std::vector<std::string>& words, const ProgramLimits& limits = {}) {
  Program program(words, limits);
  Outcome outcome;
  outcome.status = program.wait([&](std::string_view part) { outcome.model.add(part); });
  outcome.errors = program.errors();
  outcome.peak_bytes = program.peak_memory_bytes();
  return outcome;
}

/// Runs the program with a memory limit that the kernel enforces, too.
Outcome limited(const fs::path& scan, const std::string& leaf_size_mm, std::size_t limit_mb) {
  return outcome_of(command(scan, leaf_size_mm,
                            {"--threads", "1", "--memory-limit-mb", std::to_string(limit_mb)}),
                    {.data_bytes = limit_mb * mb});
}

/// The number of megabytes that an error message advises to allow.
std::size_t allowed_mb(const std::string& errors) {
  const std::size_t at = errors.find("Allow");
  const std::size_t digit = errors.find_first_of("0123456789", at);
  return digit == std::string::npos ? 0 : std::stoul(errors.substr(digit));
}

TEST(Memory, StaysBelowItsLimitWithTheSameBytes) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const Outcome free = outcome_of(command(folder.path(), "0.25"));
  ASSERT_EQ(free.status, 0) << free.errors;
  EXPECT_GT(free.model.bytes(), 50 * mb);
  for (const std::size_t limit_mb : {17U, 24U}) {
    const Outcome tight = limited(folder.path(), "0.25", limit_mb);
    EXPECT_EQ(tight.status, 0) << tight.errors;
    EXPECT_LT(tight.peak_bytes, limit_mb * mb);
    EXPECT_EQ(tight.model, free.model);
  }
}

TEST(Memory, OfASolidStaysBelowItsLimitWithTheSameBytes) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const Outcome free = outcome_of(command(folder.path(), "0.5", {}, "solid"));
  ASSERT_EQ(free.status, 0) << free.errors;
  const Outcome tight = outcome_of(
      command(folder.path(), "0.5", {"--threads", "1", "--memory-limit-mb", "48"}, "solid"));
  EXPECT_EQ(tight.status, 0) << tight.errors;
  EXPECT_LT(tight.peak_bytes, 48 * mb);
  EXPECT_GT(free.peak_bytes, 44 * mb);
  EXPECT_EQ(tight.model, free.model);
}

TEST(Memory, IsSharedByTheThreads) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const Outcome alone = outcome_of(command(folder.path(), "0.5", {"--threads", "1"}));
  const Outcome several =
      outcome_of(command(folder.path(), "0.5", {"--threads", "4", "--memory-limit-mb", "36"}));
  EXPECT_EQ(several.status, 0) << several.errors;
  EXPECT_LT(several.peak_bytes, 36 * mb);
  EXPECT_EQ(several.model, alone.model);
}

TEST(Memory, SaysHowMuchItNeedsAtLeast) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const auto solid = [&](std::size_t limit_mb) {
    return outcome_of(command(folder.path(), "2",
                              {"--threads", "1", "--memory-limit-mb", std::to_string(limit_mb)},
                              "solid"));
  };
  const Outcome refused = solid(17);
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(refused.model.bytes(), 0U);
  const std::size_t enough = allowed_mb(refused.errors);
  ASSERT_GT(enough, 17U) << refused.errors;
  const Outcome allowed = solid(enough);
  EXPECT_EQ(allowed.status, 0) << allowed.errors;
  EXPECT_LT(allowed.peak_bytes, enough * mb);
}

// A flat plate has all its leaves in one or two layers, which cannot be divided.
TEST(Memory, SaysHowMuchTheSmallestSlabNeeds) {
  const TemporaryFolder folder;
  write_small_scan(folder.path(), 2);
  for (const char* const threads : {"1", "2"}) {
    const auto words = [&](std::size_t limit_mb) {
      return command(folder.path(), "0.125",
                     {"--threads", threads, "--memory-limit-mb", std::to_string(limit_mb)});
    };
    const Outcome refused = outcome_of(words(17));
    EXPECT_EQ(refused.status, 1);
    EXPECT_EQ(refused.model.bytes(), 0U);
    const std::size_t enough = allowed_mb(refused.errors);
    ASSERT_GT(enough, 17U) << refused.errors;
    const Outcome allowed = outcome_of(words(enough));
    EXPECT_EQ(allowed.status, 0) << allowed.errors;
    EXPECT_LT(allowed.peak_bytes, enough * mb);
  }
}

/// Writes a Kinect's scan of a chamber whose floor fills a layer of the middle tile of 1 m.
void write_chamber_scan(const fs::path& folder) {
  constexpr int poses = 14;
  const Room chamber{.walls = {.min = {-0.533, -0.527, 0.103}, .max = {0.527, 0.533, 0.903}},
                     .lens = {.depth_unit = 0.0002}};
  write_room_scan(folder, chamber, poses);
}

// A floor fills whole layers, and each layer is drawn and simplified at once, with both its sides.
TEST(Memory, OfTheShellOfASpaceStaysBelowItsLimitWithTheSameBytes) {
  const TemporaryFolder folder;
  write_chamber_scan(folder.path());
  const Outcome free = outcome_of(command(folder.path(), "5", {}, "solid"));
  ASSERT_EQ(free.status, 0) << free.errors;
  for (const char* const threads : {"1", "2"}) {
    const Outcome tight = outcome_of(
        command(folder.path(), "5", {"--threads", threads, "--memory-limit-mb", "48"}, "solid"));
    EXPECT_EQ(tight.status, 0) << tight.errors;
    EXPECT_LT(tight.peak_bytes, 48 * mb);
    EXPECT_EQ(tight.model, free.model);
  }
}

TEST(Memory, OfManySmallTilesIsThatOfTheirBricks) {
  const TemporaryFolder folder;
  write_room_scan(folder.path(), small_room(), 8);
  const Outcome tiles = outcome_of(command(
      folder.path(), "4", {"--root-size-mm", "64", "--threads", "1", "--memory-limit-mb", "32"}));
  EXPECT_EQ(tiles.status, 0) << tiles.errors;
  EXPECT_LT(tiles.peak_bytes, 32 * mb);
}

TEST(Memory, SaysHowMuchTheShellOfATileNeeds) {
  const TemporaryFolder folder;
  write_chamber_scan(folder.path());
  const auto solid = [&](std::size_t limit_mb) {
    return outcome_of(command(folder.path(), "2.5",
                              {"--threads", "1", "--memory-limit-mb", std::to_string(limit_mb)},
                              "solid"));
  };
  std::size_t limit_mb = 40;
  Outcome outcome = solid(limit_mb);
  EXPECT_EQ(outcome.status, 1);
  while (outcome.status == 1) {
    ASSERT_GT(allowed_mb(outcome.errors), limit_mb) << outcome.errors;
    limit_mb = allowed_mb(outcome.errors);
    outcome = solid(limit_mb);
  }
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_LT(outcome.peak_bytes, limit_mb * mb);
}

/// The memory that a daemon takes for models of 0.1 mm beyond that for coarse ones, bytes. One
/// model is counted for a download, another is scanned up to the writing of its file.
std::size_t memory_for_fine_models(const std::string& config) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", config);
  Daemon daemon(folder.path(), {"--config", folder.path() / "octurn.json"});
  const std::string scan = daemon.start(
      R"({"snapshots": 12, "frames": 2, "leaf_size_mm": 4, "method": "intersection"})");
  EXPECT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  const std::size_t before = daemon.peak_memory();
  const Reply counted = request(daemon.port(), "HEAD", scan + "/Scan.stl?leaf_size_mm=0.1");
  EXPECT_EQ(counted.status, 200) << counted.header("Content-Length");
  const std::string fine = daemon.start(
      R"({"snapshots": 12, "frames": 2, "leaf_size_mm": 0.1, "method": "intersection"})");
  daemon.wait_until(fine, [](const nlohmann::json& now) {
    return now["phase"] != "turning" && now["phase"] != "capturing" && now["phase"] != "starting";
  });
  daemon.post(fine + "/cancel", "");
  EXPECT_EQ(daemon.wait_until_done(fine)["snapshots_done"], 12);
  return daemon.peak_memory() - before;
}

// Without a limit these models take 37 MB, so a daemon that ignores its limit fails here.
TEST(Memory, IsLimitedByTheConfigurationOfTheDaemon) {
  EXPECT_LT(memory_for_fine_models(R"({"memory_limit_mb": 32, "threads": 1})"), 32 * mb);
}

// A recorded sensor, as the simulated one takes 13 MB more, which an appliance does not. The two
// frames of its first stop differ, so the scan waits for 90 frames at each stop, and keeps none.
TEST(Memory, OfTheDaemonStaysBelowItsLimitWithARecordedSensor) {
  const TemporaryFolder folder;
  const fs::path turn = folder.path() / "turn";
  Program record({octurn_program(), "record", "--simulate", "--simulate-unit", "0",
                  "--simulate-speed", "20", "-o", turn, "--snapshots", "3", "--frames", "2"});
  ASSERT_EQ(record.wait(), 0) << record.errors();
  fs::copy_file(turn / "frames/000002.png", turn / "frames/000001.png",
                fs::copy_options::overwrite_existing);
  put(folder.path() / "octurn.json", R"({"memory_limit_mb": 48, "threads": 2})");
  Daemon daemon(folder.path(), {"--config", folder.path() / "octurn.json", "--sensor", turn});
  const std::string scan = daemon.start(R"({"snapshots": 3, "frames": 2, "leaf_size_mm": 0.5})");
  EXPECT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  EXPECT_LT(daemon.peak_memory(), 48 * mb);
}

TEST(Memory, HoldsNoMoreThanAPieceOfAnUpdate) {
  const TemporaryFolder folder;
  const fs::path appliance = folder.path() / "appliance";
  fs::create_directories(appliance / "requests");
  const Daemon daemon(folder.path(), {"--appliance", appliance});
  EXPECT_EQ(upload(daemon, std::string(1'000'000, 'x')).status, 202);
  fs::remove(appliance / "requests/update");
  const std::size_t before = daemon.peak_memory();
  EXPECT_EQ(upload(daemon, std::string(100'000'000, 'x')).status, 202);
  EXPECT_GT(before, 0U);
  EXPECT_LT(daemon.peak_memory(), before + 20'000'000);
}

// The model has 33 million triangles, 1.6 GB: 66 times the process's limit.
TEST(Memory, HoldsNoModelHoweverLarge) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const Outcome fine = limited(folder.path(), "0.125", 24);
  EXPECT_EQ(fine.status, 0) << fine.errors;
  EXPECT_LT(fine.peak_bytes, 24 * mb);
  EXPECT_GT(fine.model.bytes(), 60 * 24 * mb);
}

TEST(Memory, OfASolidIsSharedByTheThreads) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 6);
  const Outcome free = outcome_of(command(folder.path(), "0.5", {}, "solid"));
  for (const char* const threads : {"1", "2"}) {
    SCOPED_TRACE(threads);
    const Outcome tight = outcome_of(
        command(folder.path(), "0.5", {"--threads", threads, "--memory-limit-mb", "64"}, "solid"));
    EXPECT_EQ(tight.status, 0) << tight.errors;
    EXPECT_LT(tight.peak_bytes, 64 * mb);
    EXPECT_EQ(tight.model, free.model);
  }
}

}  // namespace
}  // namespace octurn
