#include <gtest/gtest.h>

#include "support/zip.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

using std::chrono::system_clock;

constexpr auto time_of_day = std::chrono::hours(23) + std::chrono::minutes(59);
constexpr system_clock::time_point some_time =
    std::chrono::sys_days(std::chrono::year(2026) / 11 / 21) + time_of_day;

/// The first file's MS-DOS date (high 16 bits) and time (low 16 bits).
unsigned dos_time(const std::string& archive) {
  unsigned time = 0;
  for (const std::size_t at : {13U, 12U, 11U, 10U}) {  // offsets in the first local header
    time = time << 8U | static_cast<unsigned char>(archive.at(at));
  }
  return time;
}

TEST(ZipArchive, GivesBackItsFilesInTheirOrder) {
  std::string large;
  for (int i = 0; i < 100'000; ++i) {
    large += std::to_string(i);
  }
  const std::vector<ArchivedFile> files{{"z.txt", "last by name"},
                                        {"empty", ""},
                                        {"large", large},
                                        {"a", std::string("\0\xff\n", 3)}};
  const std::string archive = make_zip(files, some_time);
  EXPECT_LT(archive.size(), large.size());
  const std::vector<ArchivedFile> back = unzipped(archive);
  ASSERT_EQ(back.size(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(back[i].name, files[i].name);
    EXPECT_TRUE(back[i].content == files[i].content) << files[i].name;
  }
}

TEST(ZipArchive, IsTheSameForTheSameFilesAndTime) {
  const std::vector<ArchivedFile> files{{"a", "1"}, {"b", "2"}};
  EXPECT_EQ(make_zip(files, some_time), make_zip(files, some_time));
  EXPECT_NE(make_zip(files, some_time), make_zip(files, some_time + std::chrono::seconds(2)));
}

TEST(ZipArchive, HasTheTimeInUtc) {
  const std::vector<ArchivedFile> files{{"a", "1"}};
  const unsigned date = (2026U - 1980U) << 9U | 11U << 5U | 21U;  // APPNOTE.TXT, section 4.4.6
  EXPECT_EQ(dos_time(make_zip(files, some_time)), date << 16U | 23U << 11U | 59U << 5U);
}

TEST(ZipArchive, BeginsIn1980) {
  const std::vector<ArchivedFile> files{{"a", "1"}};
  EXPECT_EQ(dos_time(make_zip(files, system_clock::time_point())), (1U << 5U | 1U) << 16U);
}

}  // namespace
}  // namespace octurn
