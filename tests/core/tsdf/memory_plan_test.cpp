#include "tsdf/memory_plan.hpp"

#include <gtest/gtest.h>

#include <string>

#include "octurn/error.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr std::size_t mb = std::size_t{1} << 20U;

ReconstructOptions options(double leaf_size, std::size_t limit_mb) {
  return {.method = Method::solid,
          .leaf_size = leaf_size,
          .clip = {.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}},
          .memory_limit = limit_mb * mb};
}

TEST(MemoryPlan, RefusesBeforeAnythingIsReadWhatItsTablesAloneExceed) {
  const Error error = error_thrown_by([] { make_reconstructor(options(0.0001, 128)); });
  EXPECT_EQ(to_string(error.code()), "memory-limit");
  EXPECT_EQ(error.parameters().at("limit_mb"), Parameters::mapped_type(128.0));
  EXPECT_GT(std::get<double>(error.parameters().at("needed_mb")), 128);
  ASSERT_NE(error.hint().find("choose a leaf size of "), std::string::npos) << error.hint();
  const double leaf_mm = std::stod(error.hint().substr(error.hint().find("size of ") + 8));
  EXPECT_GT(leaf_mm, 0.1);
  EXPECT_LE(leaf_mm, 0.8);  // twice the leaf size that fits 64 MB: an eighth of the bricks
  EXPECT_NO_THROW(make_reconstructor(options(leaf_mm / 1000, 128)));
}

TEST(MemoryPlan, ExpectsMoreForFinerLeavesAndNamesThoseThatFit) {
  const MemoryNeed coarse = expected_memory(options(0.001, 0));
  const MemoryNeed fine = expected_memory(options(0.00025, 0));
  EXPECT_GT(coarse.bytes, 20 * mb);
  EXPECT_LT(coarse.bytes, 64 * mb);
  EXPECT_GT(fine.bytes, 4 * coarse.bytes);
  EXPECT_EQ(fine.fitting_leaf_size, 0.00025);  // without a limit all fits

  const MemoryNeed limited = expected_memory(options(0.00025, 64));
  EXPECT_GT(limited.fitting_leaf_size, 0.00025);
  EXPECT_LE(expected_memory(options(limited.fitting_leaf_size, 0)).bytes, 64 * mb);
  EXPECT_GT(expected_memory(options(limited.fitting_leaf_size / 2, 0)).bytes, 64 * mb);
}

}  // namespace
}  // namespace octurn
