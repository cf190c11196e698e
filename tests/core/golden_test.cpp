#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "support/checksum.hpp"

// Small scans whose models are known to the last byte. They are the same for every processor,
// compiler and number of threads.

namespace octurn {
namespace {

namespace fs = std::filesystem;

struct Golden {
  std::string scan = {};
  ReconstructOptions options = {};
  std::uint64_t facets = 0;
  std::uint64_t checksum = 0;  // of the whole STL file
};

/// GoogleTest prints a parameter this way, and CTest has it in the test's name.
void PrintTo(const Golden& golden, std::ostream* out) {  // NOLINT(readability-identifier-naming)
  *out << golden.scan;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class GoldenScan : public testing::TestWithParam<Golden> {};

TEST_P(GoldenScan, GivesTheSameFile) {
  const Golden& golden = GetParam();
  const fs::path folder = fs::path(OCTURN_GOLDEN) / golden.scan;
  const Scan scan = read_scan(folder);
  const SnapshotSource snapshots{.count = scan.shots.size(), .read = [&](std::size_t i) {
                                   return read_snapshot(folder, scan, scan.shots[i]);
                                 }};
  for (const int threads : {1, 2}) {
    ReconstructOptions options = golden.options;
    options.clip = scan.clip;
    options.threads = threads;
    const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
    reconstruction->add(snapshots);
    const SurfaceCount count = reconstruction->count(snapshots);
    EXPECT_EQ(count.facets, golden.facets);
    Checksum stl;
    const auto header = stl_header(count.facets);
    stl.add(text_of(header));
    reconstruction->surface(
        snapshots, [&](std::span<const Facet> facets) { stl.add(text_of(std::as_bytes(facets))); });
    EXPECT_EQ(stl.sum(), golden.checksum);
  }
}

ReconstructOptions intersection(double leaf_size, std::optional<int> level = {}) {
  return {.leaf_size = leaf_size, .level = level};
}

ReconstructOptions solid(double leaf_size,
                         double target_error = ReconstructOptions().target_error) {
  return {.method = Method::solid, .leaf_size = leaf_size, .target_error = target_error};
}

std::string name_of_golden(const testing::TestParamInfo<Golden>& named) {
  const ReconstructOptions& options = named.param.options;
  std::string name = named.param.scan + "_" + std::string(to_string(options.method)) + "_" +
                     std::to_string(static_cast<int>(options.leaf_size * 1e6)) + "um";
  if (options.level) {
    name += "_level_" + std::to_string(*options.level);
  }
  return options.target_error == 0 ? name + "_whole" : name;
}

INSTANTIATE_TEST_SUITE_P(
    Golden, GoldenScan,
    testing::Values(Golden{"figure_scan", intersection(0.004), 35444, 0x17bd0167601e9706U},
                    Golden{"figure_scan", intersection(0.002), 135152, 0xffb242a7b612b7edU},
                    Golden{"figure_scan", intersection(0.001, 7), 8992, 0xf1a326bd52c41826U},
                    Golden{"tower_scan", intersection(0.002), 87336, 0xb64d3c95e521210bU},
                    Golden{"tower_scan", intersection(0.001), 348860, 0x343286fd1d4d3509U},
                    Golden{"tower_scan", intersection(0.0005, 8), 21608, 0x21cb0ba7ab681d39U},
                    Golden{"figure_scan", solid(0.004), 5352, 0x3a6253e1f0360e73U},
                    Golden{"figure_scan", solid(0.002, 0), 26808, 0x78eb8146b2344399U},
                    Golden{"figure_scan", solid(0.001), 33218, 0xdb5a43258c7d6f90U},
                    Golden{"tower_scan", solid(0.002), 7320, 0xae31ba899c96873dU},
                    Golden{"tower_scan", solid(0.001, 0), 59040, 0xc2e82f504f219112U},
                    Golden{"tower_scan", solid(0.001, 0.0002), 3694, 0x666532dc256c16bdU}),
    name_of_golden);

}  // namespace
}  // namespace octurn
