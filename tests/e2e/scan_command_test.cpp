// `octurn scan`, and the treatment of output paths, common to all commands.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "support/program.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// The command for a quick scan of the simulated rig.
std::vector<std::string> scan_to(const fs::path& data, const std::string& output) {
  return {octurn_program(),
          "scan",
          "--simulate",
          "--simulate-speed",
          "50",
          "--data",
          data,
          "--snapshots",
          "2",
          "--frames",
          "2",
          "--leaf-size-mm",
          "4",
          "-o",
          output};
}

/// A command as a shell line, followed by `more`.
std::string shell_line(const std::vector<std::string>& words, const std::string& more) {
  std::string line;
  for (const std::string& word : words) {
    line += "'" + word + "' ";
  }
  return line + more;
}

TEST(ScanCommand, RefusesAnOutputThatCannotBeBeforeItScans) {
  const TemporaryFolder folder;
  const fs::path data = folder.path() / "data";
  for (const std::string& output :
       {std::string("/nonexistent/Scan.stl"), std::string("/dev/full"), folder.path().string()}) {
    Program program(scan_to(data, output));
    EXPECT_EQ(program.wait(), 1) << output;
    EXPECT_NE(program.errors().find(output), std::string::npos) << program.errors();
  }
  Program program(scan_to(data, ""));
  EXPECT_EQ(program.wait(), 2);
  EXPECT_NE(program.errors().find("--output"), std::string::npos) << program.errors();
  EXPECT_FALSE(fs::exists(data / "scans"));
}

TEST(ScanCommand, GivesTheModelToStandardOutput) {
  const TemporaryFolder folder;
  const fs::path data = folder.path() / "data";
  Program program(scan_to(data, "-"));
  ASSERT_EQ(program.wait(), 0) << program.errors();
  EXPECT_FALSE(fs::exists("-"));
  const fs::path stored = fs::directory_iterator(data / "scans")->path();
  EXPECT_TRUE(program.output() == content_of(stored / "Scan.stl"));
}

TEST(ScanCommand, TellsWhereTheModelIsThatItCouldNotHandOver) {
  const TemporaryFolder folder;
  const fs::path data = folder.path() / "data";
  Program program({"/bin/sh", "-c", shell_line(scan_to(data, "-"), ">/dev/full")});
  EXPECT_EQ(program.wait(), 1);
  const fs::path stored = fs::directory_iterator(data / "scans")->path();
  EXPECT_NE(program.errors().find((stored / "Scan.stl").string()), std::string::npos)
      << program.errors();
}

TEST(ScanCommand, RefusesOptionsOfTheOtherMethod) {
  const TemporaryFolder folder;
  std::vector<std::string> words = scan_to(folder.path() / "data", folder.path() / "Scan.stl");
  words.insert(words.end(), {"--threshold-m2", "0.001"});
  Program program(words);
  EXPECT_EQ(program.wait(), 2);
  EXPECT_NE(program.errors().find("--threshold-m2"), std::string::npos) << program.errors();
}

TEST(Commands, RefuseAnEmptyDataFolder) {
  for (const char* const command : {"serve", "scan", "doctor"}) {
    Program program({octurn_program(), command, "--simulate", "--data", ""});
    EXPECT_EQ(program.wait(), 2) << command;
    EXPECT_NE(program.errors().find("\"data\""), std::string::npos) << program.errors();
  }
}

TEST(DoctorCommand, EndsWith1WhereItsFindingsCannotBeWritten) {
  const TemporaryFolder folder;
  for (const char* const more : {">/dev/full", "--json >/dev/full"}) {
    Program program(
        {"/bin/sh", "-c",
         shell_line({octurn_program(), "doctor", "--simulate", "--data", folder.path()}, more)});
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("standard output"), std::string::npos) << program.errors();
  }
}

TEST(ScanCommand, ScansAndWritesTheModel) {
  const TemporaryFolder folder;
  const std::vector<std::string> command{octurn_program(),
                                         "scan",
                                         "--simulate",
                                         "--simulate-speed",
                                         "20",
                                         "--data",
                                         folder.path() / "data",
                                         "-o",
                                         folder.path() / "Scan.stl",
                                         "--snapshots",
                                         "3",
                                         "--frames",
                                         "2",
                                         "--leaf-size-mm",
                                         "4"};
  Program program(command);
  EXPECT_EQ(program.wait(), 0) << program.errors();
  const std::string stl = content_of(folder.path() / "Scan.stl");
  EXPECT_GT(triangles_of_whole_stl(stl), 1000);
  EXPECT_EQ(open_edges(stl), 0);
}

TEST(ScanCommand, TellsTheVerdictAndItsReport) {
  const TemporaryFolder folder;
  std::vector<std::string> words = scan_to(folder.path() / "data", folder.path() / "Scan.stl");
  words.emplace_back("--json");
  Program program(words);
  ASSERT_EQ(program.wait(), 0) << program.errors();
  const auto report = nlohmann::json::parse(program.output());
  EXPECT_EQ(report["state"], "finished");
  EXPECT_EQ(report["model"]["bytes"], fs::file_size(folder.path() / "Scan.stl"));
  const auto quality = report["model"]["quality"];
  EXPECT_NE(quality["verdict"], "good") << "two stops do not see an object all around";
  EXPECT_NE(program.errors().find(quality["reasons"][0]["detail"]), std::string::npos)
      << program.errors();
}

TEST(ScanCommand, SaysWhereScansAreIfItKnowsNoneOfThatId) {
  const TemporaryFolder folder;
  for (const char* const option : {"--resume", "--pose-of"}) {
    std::vector<std::string> words = scan_to(folder.path() / "data", folder.path() / "Scan.stl");
    words.insert(words.end(), {option, "nope"});
    Program program(words);
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("nope: is no scan in " + (folder.path() / "data").string()),
              std::string::npos)
        << program.errors();
  }
}

TEST(ScanCommand, StopsWhenItIsInterrupted) {
  const TemporaryFolder folder;
  Program program({octurn_program(), "scan", "--simulate", "--snapshots", "200", "--data",
                   folder.path() / "data", "-o", folder.path() / "Scan.stl"});
  while (!fs::exists(folder.path() / "data" / "scans")) {
    std::this_thread::yield();
  }
  program.send_signal(SIGINT);
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.errors().find("stopped"), std::string::npos) << program.errors();
  EXPECT_FALSE(fs::exists(folder.path() / "Scan.stl"));
}

TEST(ScanCommand, RefusesSettingsThatAreWrong) {
  const TemporaryFolder folder;
  Program program({octurn_program(), "scan", "--simulate", "--data", folder.path() / "data",
                   "--snapshots", "0"});
  EXPECT_EQ(program.wait(), 2);
  EXPECT_NE(program.errors().find("snapshots"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder.path() / "data"));
}

}  // namespace
}  // namespace octurn
