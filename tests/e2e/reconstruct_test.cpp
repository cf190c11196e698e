#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/patience.hpp"
#include "support/program.hpp"
#include "support/small_scan.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"
#include "version.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

class ReconstructCommand : public ::testing::Test {
 protected:
  ReconstructCommand() { write_small_scan(scan_, 4); }

  /// The command `octurn reconstruct SCAN -o OUTPUT --method METHOD` with more options.
  std::vector<std::string> command(std::vector<std::string> more = {},
                                   const std::string& method = "intersection") const {
    std::vector<std::string> words{octurn_program(), "reconstruct", scan_.string(), "-o",
                                   output_.string(), "--method",    method};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// The number of files beside the output; a failed run must not leave any.
  int files_left() const {
    return static_cast<int>(
        std::distance(fs::directory_iterator(output_.parent_path()), fs::directory_iterator()));
  }

  /// Fails unless the program ends with that status and one line on standard error, and leaves no
  /// file.
  void expect_failure(const std::vector<std::string>& words, int status, const std::string& says,
                      const ProgramLimits& limits = {}) const {
    Program program(words, limits);
    EXPECT_EQ(program.wait(), status) << program.errors();
    EXPECT_EQ(program.output(), "");
    EXPECT_NE(program.errors().find(says), std::string::npos) << program.errors();
    if (status == 1) {
      EXPECT_EQ(std::ranges::count(program.errors(), '\n'), 1) << program.errors();
    }
    EXPECT_EQ(files_left(), 0);
  }

  TemporaryFolder folder_;
  fs::path scan_ = folder_.path() / "scan";
  fs::path output_ = [this] {
    fs::create_directory(folder_.path() / "out");
    return folder_.path() / "out" / "Scan.stl";
  }();
};

TEST_F(ReconstructCommand, WritesAClosedModelInMillimetres) {
  Program program(command());
  EXPECT_EQ(program.wait(), 0) << program.errors();
  EXPECT_EQ(program.output(), "");
  EXPECT_EQ(program.errors(), "");
  const std::string stl = content_of(output_);
  EXPECT_GT(triangles_of_whole_stl(stl), 10'000);
  EXPECT_EQ(open_edges(stl), 0);
}

TEST_F(ReconstructCommand, ReportsOneLineOfJson) {
  Program program(command({"--json", "--leaf-size-mm", "2"}));
  EXPECT_EQ(program.wait(), 0);
  EXPECT_EQ(std::ranges::count(program.output(), '\n'), 1);
  const auto report = nlohmann::json::parse(program.output());
  EXPECT_EQ(report["triangles"], triangles_of_whole_stl(content_of(output_)));
  EXPECT_EQ(report["bytes"], fs::file_size(output_));
  EXPECT_EQ(report["watertight"], true);
  // A horizontal square of 70 / 575.8 * 650 = 79 mm, seen at 4 stops; leaves of 1.95 mm make it a
  // plate.
  EXPECT_NEAR(report["size_mm"][0].get<double>(), 79, 6);
  EXPECT_NEAR(report["size_mm"][2].get<double>(), 2, 2);
  EXPECT_EQ(report["settings"]["leaf_size_mm"], 2.0);
  EXPECT_GT(report["peak_memory_bytes"], 1'000'000);
  EXPECT_GT(report["seconds"]["total"], 0);
}

TEST_F(ReconstructCommand, GivesTheSameBytesToStandardOutput) {
  Program to_file(command());
  ASSERT_EQ(to_file.wait(), 0);
  auto words = command({"--json"});
  words[4] = "-";
  Program to_output(words);
  EXPECT_EQ(to_output.wait(), 0);
  EXPECT_TRUE(to_output.output() == content_of(output_));
  EXPECT_TRUE(nlohmann::json::accept(to_output.errors())) << to_output.errors();
}

TEST_F(ReconstructCommand, GivesTheSameBytesWithAnyThreadsAndMemory) {
  Program plain(command({"--threads", "1"}));
  ASSERT_EQ(plain.wait(), 0);
  const std::string expected = content_of(output_);
  Program limited(command({"--threads", "3", "--memory-limit-mb", "40"}));
  ASSERT_EQ(limited.wait(), 0) << limited.errors();
  EXPECT_TRUE(content_of(output_) == expected);
}

TEST_F(ReconstructCommand, TakesTheClipBoxAndTheLevelGiven) {
  Program coarse(command({"--level", "8", "--json"}));
  ASSERT_EQ(coarse.wait(), 0);
  Program as_coarse(command({"--leaf-size-mm", "4", "--json"}));
  ASSERT_EQ(as_coarse.wait(), 0);
  EXPECT_EQ(nlohmann::json::parse(coarse.output())["triangles"],
            nlohmann::json::parse(as_coarse.output())["triangles"]);
  Program clipped(command({"--clip-mm", "0", "-140", "2", "140", "140", "400", "--json"}));
  ASSERT_EQ(clipped.wait(), 0);
  EXPECT_NEAR(nlohmann::json::parse(clipped.output())["size_mm"][0].get<double>(), 39.5, 4);
}

TEST_F(ReconstructCommand, EndsWith2ForBadUsage) {
  expect_failure({octurn_program()}, 2, "subcommand");
  expect_failure({octurn_program(), "levitate"}, 2, "\"levitate\" is no command");
  expect_failure({octurn_program(), "reconstruct", scan_.string()}, 2, "--output");
  expect_failure(command({"--leaf-size"}), 2, "--leaf-size");
  expect_failure(command({"--leaf-size-mm", "one"}), 2, "--leaf-size-mm");
  for (const char* const size : {"0", "-1", "nan", "1001", "1e300"}) {
    expect_failure(command({"--leaf-size-mm", size}), 2, "leaf_size_mm");
  }
  expect_failure(command({"--root-size-mm", "0"}), 2, "root_size_mm");
  expect_failure(command({"--root-size-mm", "1e308"}), 2, "\"root_size_mm\" is 1e+308");
  expect_failure(command({"--threshold-m2", "0"}), 2, "threshold_m2");
  expect_failure(command({"--clip-mm", "1", "2", "3"}), 2, "--clip-mm");
  expect_failure(command({"--clip-mm", "0", "0", "0", "0", "1", "1"}), 2, "clip_mm");
  expect_failure(command({"--clip-mm", "0", "0", "0", "1e-7", "1", "1"}), 2, "clip_mm");
  for (const char* const method : {"solid", "intersection"}) {
    expect_failure(
        command({"--clip-mm", "-1e300", "-1e300", "-1e300", "1e300", "1e300", "1e300"}, method), 2,
        "clip_mm");
  }
  for (const char* const mb : {"0", "1e-9", "16", "nan", "inf", "1e300"}) {
    expect_failure(command({"--memory-limit-mb", mb}), 2, "memory_limit_mb");
  }
  expect_failure(command({"--level", "99"}), 2, "level");
  expect_failure(command({"--level", "3"}, "solid"), 2, "--level");
  expect_failure(command({"--max-error-mm", "1"}), 2, "--max-error-mm");
  expect_failure(command({"--threads", "0"}), 2, "threads");
}

TEST_F(ReconstructCommand, EndsWith1AndOneLineForAScanThatIsBroken) {
  expect_failure({octurn_program(), "reconstruct", "/nowhere", "-o", output_.string()}, 1,
                 "/nowhere");
  put(scan_ / "snapshots" / "001.png", content_of(scan_ / "snapshots" / "001.png").substr(0, 400));
  expect_failure(command(), 1, "001.png");
  fs::remove(scan_ / "snapshots" / "001.png");
  expect_failure(command(), 1, "001.png");
  put(scan_ / "scan.json", R"({"format": "octurn-scan", "version": 2})");
  expect_failure(command(), 1, "version");
}

TEST_F(ReconstructCommand, EndsWith1WhereThereIsNoSurface) {
  expect_failure(command({"--clip-mm", "-5", "-5", "300", "5", "5", "310"}), 1, "no surface");
}

TEST_F(ReconstructCommand, EndsWith1WhereItCannotWrite) {
  auto words = command();
  words[4] = (folder_.path() / "missing" / "Scan.stl").string();
  expect_failure(words, 1, "missing");
  words[4] = (folder_.path() / "out").string();
  expect_failure(words, 1, "out");
}

TEST_F(ReconstructCommand, RefusesAnOutputThatCannotBeBeforeItReadsTheScan) {
  const auto with_output = [](const std::string& output) {
    return std::vector<std::string>{octurn_program(), "reconstruct", "/nowhere", "-o", output};
  };
  expect_failure(with_output(""), 2, "--output");
  expect_failure(with_output("/dev/full"), 1, "/dev/full");
  expect_failure(with_output((folder_.path() / "out").string()), 1, "out");
}

TEST_F(ReconstructCommand, ReplacesNoFileOfItsScan) {
  for (const char* const file : {"scan.json", "snapshots/001.png", "snapshots/../scan.json"}) {
    std::vector<std::string> words = command();
    words[4] = (scan_ / file).string();
    const std::string before = content_of(words[4]);
    expect_failure(words, 2, "must not be a file of the scan");
    EXPECT_TRUE(content_of(words[4]) == before);
  }
}

TEST_F(ReconstructCommand, EndsWith1WhereItsReportCannotBeWritten) {
  const std::string line = octurn_program() + " reconstruct " + scan_.string() + " -o " +
                           output_.string() + " --json > /dev/full";
  Program program({"/bin/sh", "-c", line});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.errors().find("standard output"), std::string::npos) << program.errors();
}

TEST_F(ReconstructCommand, TellsItsOwnMemoryAndNotThatOfItsParent) {
  std::vector<char> large(std::size_t{512} << 20U, 'x');  // memory of this process, the parent
  Program program(command({"--json"}));
  EXPECT_EQ(program.wait(), 0);
  EXPECT_LT(nlohmann::json::parse(program.output())["peak_memory_bytes"], large.size());
}

TEST_F(ReconstructCommand, EndsWith1WhenTheDiskIsFull) {
  expect_failure(command(), 1, "cannot write", {.file_bytes = 100'000});
}

TEST_F(ReconstructCommand, LeavesAnEarlierModelAloneWhenItFails) {
  put(output_, "an earlier model");
  Program program(command(), {.file_bytes = 100'000});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_EQ(content_of(output_), "an earlier model");
  EXPECT_EQ(files_left(), 1);
}

TEST_F(ReconstructCommand, RemovesThePartialFileWhenItIsInterrupted) {
  for (const int signal : {SIGINT, SIGTERM}) {
    // Leaves so small that writing takes seconds.
    Program program(command({"--leaf-size-mm", "0.1"}));
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (files_left() == 0 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
    }
    program.send_signal(signal);
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("stopped"), std::string::npos) << program.errors();
    EXPECT_EQ(files_left(), 0);
  }
}

TEST(Octurn, TellsItsVersionAndItsUse) {
  Program version({octurn_program(), "--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_EQ(version.output(), "octurn " + std::string(octurn::version()) + "\n");
  Program help({octurn_program(), "--help"});
  EXPECT_EQ(help.wait(), 0);
  for (const char* const command : {"serve", "scan", "reconstruct"}) {
    EXPECT_NE(help.output().find(command), std::string::npos);
  }
}

}  // namespace
}  // namespace octurn
