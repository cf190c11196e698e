// A fill has the same bits for any number of threads.

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "octurn/snapshot.hpp"
#include "tsdf/laplace_fill.hpp"

namespace octurn {
namespace {

constexpr std::array<int, 4> team_sizes = {2, 3, 4, 7};

/// A grid of which an eighth is known, at random.
PartialGrid random_grid(const Index3& size) {
  PartialGrid grid{.size = size, .values = {}, .known = {}};
  std::mt19937 random(11);
  for (std::size_t i = 0; i < grid.index(0, 0, size.z); ++i) {
    const bool is_known = random() % 8 == 0;
    grid.values.push_back(is_known ? static_cast<float>(random() % 2001) - 1000 : 0.0F);
    grid.known.push_back(is_known ? 1 : 0);
  }
  return grid;
}

TEST(LaplaceThreads, ChangeNoBit) {
  for (const Index3 size : {Index3{40, 61, 30}, Index3{7, 16, 3}, Index3{30, 9, 20}}) {
    const std::vector<float> alone = laplace_fill(random_grid(size)).values;
    for (const int threads : team_sizes) {
      ThreadTeam team(threads);
      EXPECT_EQ(laplace_fill(random_grid(size), {}, team).values, alone) << threads << " threads";
    }
  }
}

TEST(LaplaceThreads, EndTogetherWhenStopped) {
  std::stop_source stop;
  stop.request_stop();
  ThreadTeam team(4);
  EXPECT_THROW(laplace_fill(random_grid({40, 61, 30}), stop.get_token(), team), Stopped);
}

}  // namespace
}  // namespace octurn
