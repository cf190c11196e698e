// What a scanner does with archives that do not come whole, are no scans, or come when it ends.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "app/scanner_fixture.hpp"
#include "support/archive.hpp"
#include "support/small_scan.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

class ScannerImport : public ScannerTest {
 protected:
  /// Puts a scan into the bin.
  void discard_a_scan() {
    Job job = store_.create({});
    job.state = JobState::finished;
    store_.save(job);
    store_.discard(job.id);
  }

  bool has_no_scans() const {
    return store_.list().empty() && std::filesystem::is_empty(folder_.path() / "scans");
  }
};

TEST_F(ScannerImport, LeavesTheBinAloneIfNothingArrivesOfWhatWasAnnounced) {
  discard_a_scan();
  Scanner scanner(rig(), {.threads = 1}, store_);
  const auto code_of = [&](std::uint64_t bytes) {
    ArchiveSource nothing = source_of("");
    nothing.bytes = bytes;
    return code_thrown_by([&] { scanner.adopt(nothing); });
  };
  EXPECT_EQ(code_of(std::uint64_t{1} << 50U), "disk-full");
  EXPECT_EQ(code_of(1000), "cut-short");
  EXPECT_EQ(store_.bin().list().size(), 1U);
  EXPECT_TRUE(has_no_scans());
}

TEST_F(ScannerImport, LeavesNothingOfWhatIsNoArchive) {
  Scanner scanner(rig(), {.threads = 1}, store_);
  EXPECT_EQ(code_thrown_by([&] { scanner.adopt(source_of(std::string(100'000, 'x'))); }),
            "bad-request");
  EXPECT_TRUE(has_no_scans());
}

TEST_F(ScannerImport, EndsWithTheScanner) {
  const TemporaryFolder other;
  write_small_scan(other.path(), 2);
  Scanner scanner(rig(), {.threads = 1}, store_);
  const ArchiveSource archive =
      source_of(archive_of(other.path()), [&] { scanner.request_stop(); });
  const Error error = error_thrown_by([&] { scanner.adopt(archive); });
  EXPECT_EQ(error.code(), ErrorCode::busy);
  EXPECT_STREQ(error.what(), "Octurn is ending");
  EXPECT_TRUE(has_no_scans());
}

}  // namespace
}  // namespace octurn
