// docs/commands.md names what the program has: each command, and each option somewhere in the
// documents.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

std::string help_of(const std::vector<std::string>& command) {
  std::vector<std::string> words{octurn_program()};
  words.insert(words.end(), command.begin(), command.end());
  words.emplace_back("--help");
  Program program(words);
  EXPECT_EQ(program.wait(), 0) << program.errors();
  return program.output();
}

/// All first groups of a pattern's matches.
std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> all;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
    all.insert((*match)[1]);
  }
  return all;
}

/// The commands in the help's list after "Subcommands:".
std::set<std::string> commands() {
  const std::string help = help_of({});
  return matches(help.substr(help.find("Subcommands:")), "\n  ([a-z]+) ");
}

/// The options that a command's help lists.
std::set<std::string> options_of(const std::vector<std::string>& command) {
  return matches(help_of(command), "\n  (?:-[a-z],)?(--[a-z-]+)");
}

std::set<std::string> all_options() {
  std::set<std::string> all = options_of({"import", "tum"});
  for (const std::string& command : commands()) {
    all.merge(options_of({command}));
  }
  return all;
}

std::string all_documents() {
  std::string text;
  for (const fs::directory_entry& entry : fs::directory_iterator(OCTURN_SOURCE "/docs")) {
    if (entry.path().extension() == ".md") {
      text += content_of(entry.path());
    }
  }
  return text;
}

TEST(CommandDocument, ListsTheCommandsOfTheProgram) {
  const std::string document = content_of(OCTURN_SOURCE "/docs/commands.md");
  EXPECT_EQ(matches(document, "\n\\| `octurn ([a-z]+)"), commands());
}

TEST(CommandDocument, NamesNoOptionThatNoCommandHas) {
  const std::set<std::string> options = all_options();
  EXPECT_GT(options.size(), 40U);
  for (const std::string& named :
       matches(content_of(OCTURN_SOURCE "/docs/commands.md"), "(--[a-z][a-z-]+)")) {
    EXPECT_TRUE(options.contains(named)) << named;
  }
}

// An option that is a setting is in the tables of docs/settings.md by its key.
TEST(CommandDocument, AndTheOthersNameEachOption) {
  const std::string documents = all_documents();
  for (const std::string& option : all_options()) {
    std::string key = option.substr(2);
    std::ranges::replace(key, '-', '_');
    EXPECT_TRUE(documents.find(option) != std::string::npos ||
                documents.find("`" + key + "`") != std::string::npos)
        << option;
  }
}

TEST(CommandDocument, WritesNumbersOfTheHelpOut) {
  for (const std::string& command : commands()) {
    EXPECT_EQ(matches(help_of({command}), "([0-9]e\\+[0-9]+)"), std::set<std::string>()) << command;
  }
  EXPECT_EQ(matches(help_of({"import", "tum"}), "([0-9]e\\+[0-9]+)"), std::set<std::string>());
}

// The default method is told once by each: a model of the same folder is the same by either.
TEST(CommandDocument, TellsTheDefaultMethodOfTheHelp) {
  EXPECT_NE(help_of({"reconstruct"}).find("(solid; of a space: intersection)"), std::string::npos);
  EXPECT_NE(content_of(OCTURN_SOURCE "/docs/commands.md")
                .find("The method is `solid`; of a space, whose poses are free, `intersection`."),
            std::string::npos);
}

}  // namespace
}  // namespace octurn
