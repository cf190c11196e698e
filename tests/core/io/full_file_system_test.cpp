// A file system that accepts no byte: pwrite returns 0, which POSIX allows and the kernel's own
// file systems do not do.

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <span>
#include <string_view>

#include "io/unnamed_file.hpp"
#include "octurn/file.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace {

int refused_writes = 0;  // calls of pwrite to come that write nothing

}  // namespace

// In place of the C library's, for all of this program's tests.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" ssize_t pwrite(int file, const void* bytes, size_t size, off_t offset) {
  if (refused_writes > 0) {
    --refused_writes;
    return 0;
  }
  return ::syscall(SYS_pwrite64, file, bytes, size, offset);
}

namespace octurn {
namespace {

class FullFileSystem : public ::testing::Test {
 protected:
  FullFileSystem() { refused_writes = 2; }
  ~FullFileSystem() override { refused_writes = 0; }

  TemporaryFolder folder_ = {};
};

TEST_F(FullFileSystem, EndsAnAtomicFile) {
  EXPECT_EQ(code_thrown_by([&] { write_file(folder_.path() / "Scan.stl", "solid"); }), "disk-full");
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(FullFileSystem, EndsAnUnnamedFile) {
  UnnamedFile file(folder_.path());
  constexpr std::string_view text = "solid";
  EXPECT_EQ(code_thrown_by([&] { file.append(std::as_bytes(std::span(text))); }), "disk-full");
}

}  // namespace
}  // namespace octurn
