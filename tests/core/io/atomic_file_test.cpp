#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <string>

#include "octurn/file.hpp"
#include "support/small_disk.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

std::ptrdiff_t files_in(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), {});
}

/// Drops root's privileges during its lifetime, so that tests run by root see permissions enforced.
class WithoutPrivileges {
 public:
  WithoutPrivileges() {
    if (::geteuid() == 0) {
      EXPECT_EQ(::seteuid(65534), 0);
    }
  }
  ~WithoutPrivileges() { EXPECT_EQ(::seteuid(::getuid()), 0); }
  WithoutPrivileges(const WithoutPrivileges&) = delete;
  WithoutPrivileges& operator=(const WithoutPrivileges&) = delete;
};

TEST(AtomicFile, AppearsWithItsWholeContentWhenCommitted) {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  AtomicFile file(target);
  file.write(bytes_of("solid "));
  file.write(bytes_of("vase"));
  EXPECT_FALSE(std::filesystem::exists(target));

  file.commit();

  EXPECT_EQ(content_of(target), "solid vase");
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(AtomicFile, OverwritesInPlaceWithoutMovingItsEnd) {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  AtomicFile file(target);
  file.write(bytes_of("count=????;"));

  file.write_at(6, bytes_of("1234"));
  file.write(bytes_of("end"));
  file.commit();

  EXPECT_EQ(content_of(target), "count=1234;end");
}

TEST(AtomicFile, KeepsEveryByteOfALargeFile) {
  // A file of this size is written past the page cache, except for its end and overwritten ranges.
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  std::string model;
  AtomicFile file(target);
  for (int piece = 0; model.size() < 5'000'000; ++piece) {
    const std::string bytes(static_cast<std::size_t>(1 + piece % 977), static_cast<char>(piece));
    file.write(bytes_of(bytes));
    model += bytes;
  }
  file.write_at(3, bytes_of("count"));
  file.write(bytes_of(model));
  model = std::string(model).replace(3, 5, "count") + model;

  file.commit();

  EXPECT_TRUE(content_of(target) == model);
}

TEST(AtomicFile, SaysDiskFullInTheMidstOfALargeFile) {
  const TemporaryFolder folder;
  const std::string model(3'000'000, 'x');
  const SmallDisk disk(2'500'000);

  EXPECT_EQ(code_thrown_by([&] { write_file(folder.path() / "Scan.stl", model); }), "disk-full");
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(AtomicFile, LeavesNothingBehindWhenNotCommitted) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder.path() / "Scan.stl");
    file.write(bytes_of("half a model"));
    EXPECT_EQ(files_in(folder.path()), 1);
  }
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(AtomicFile, KeepsTheOldFileUntilTheNewOneIsCommitted) {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  put(target, "old");
  AtomicFile file(target);
  file.write(bytes_of("new"));
  EXPECT_EQ(content_of(target), "old");

  file.commit();

  EXPECT_EQ(content_of(target), "new");
}

TEST(AtomicFile, LetsSeveralBeWrittenForOneTarget) {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.path() / "Scan.stl";
  AtomicFile first(target);
  AtomicFile second(target);
  first.write(bytes_of("first"));
  second.write(bytes_of("second"));

  first.commit();
  second.commit();

  EXPECT_EQ(content_of(target), "second");
}

TEST(AtomicFile, HasTheModeThatTheUserAskedFor) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(0027);
  write_file(folder.path() / "octurn.json", "{}");
  ::umask(before);

  struct stat status {};
  ASSERT_EQ(::stat((folder.path() / "octurn.json").c_str(), &status), 0);

  EXPECT_EQ(status.st_mode & 0777U, 0640U);
}

TEST(AtomicFile, SaysDiskFullAndLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string model(8192, 'x');
  const SmallDisk disk(4096);

  const std::string code = code_thrown_by([&] { write_file(folder.path() / "Scan.stl", model); });

  EXPECT_EQ(code, "disk-full");
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(AtomicFile, SaysDiskFullWhenOverwritingGrowsTheFile) {
  const TemporaryFolder folder;
  AtomicFile file(folder.path() / "Scan.stl");
  const SmallDisk disk(4096);

  EXPECT_EQ(code_thrown_by([&] { file.write_at(4095, bytes_of("12")); }), "disk-full");
}

TEST(AtomicFile, RefusesAFolderThatIsMissing) {
  const TemporaryFolder folder;

  EXPECT_EQ(code_thrown_by([&] { AtomicFile(folder.path() / "missing" / "Scan.stl"); }),
            "write-failed");
}

TEST(AtomicFile, RefusesAFolderThatMayNotBeWrittenTo) {
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms{0555});
  const WithoutPrivileges nobody;

  EXPECT_EQ(code_thrown_by([&] { AtomicFile(folder.path() / "Scan.stl"); }), "write-failed");
}

TEST(AtomicFile, RefusesToReplaceAFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "Scan.stl");

  EXPECT_EQ(code_thrown_by([&] { AtomicFile(folder.path() / "Scan.stl"); }), "write-failed");
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "Scan.stl"));
}

TEST(AtomicFile, RefusesToReplaceWhatIsNoFile) {
  // Otherwise root could replace /dev/null by a regular file, for every program on the machine.
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);

  EXPECT_EQ(code_thrown_by([&] { write_file(pipe, "model"); }), "write-failed");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

}  // namespace
}  // namespace octurn
