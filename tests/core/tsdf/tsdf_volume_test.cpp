#include "tsdf/tsdf_volume.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/tsdf/random_field.hpp"
#include "core/tsdf/rendered.hpp"
#include "tsdf/integrate.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

const Box clip_box{.min = {-0.05, -0.05, 0.002}, .max = {0.05, 0.05, 0.06}};

VoxelGrid grid() { return VoxelGrid(1.0, 10, clip_box, 0.005); }

TEST(VoxelGrid, CoversTheClipBoxAndAnEmptyBorder) {
  const VoxelGrid grid = octurn::grid();
  const double brick = grid.voxel_side() * VoxelGrid::brick_side;
  const Box box = grid.box();
  EXPECT_EQ(grid.voxel_side(), 1.0 / 1024);
  for (int axis = 0; axis < 3; ++axis) {
    // The border brick lies outside the clip box, next to the brick that holds the box's side.
    EXPECT_LE(box.min[axis] + brick, clip_box.min[axis]);
    EXPECT_GE(box.max[axis] - brick, clip_box.max[axis]);
    EXPECT_GT(box.max[axis] - 2 * brick, clip_box.max[axis] - brick);
  }
  EXPECT_EQ(box.min.z(), -brick);  // the first layer above the border stands on the platform
}

TEST(VoxelGrid, CoversTheRootOfAClipBoxBeyondTheRangeOfInt) {
  const Box root{.min = {-0.5, -0.5, 0}, .max = {0.5, 0.5, 1}};
  const VoxelGrid of_root(1.0, 10, root, 0.005);
  for (const double far : {1e6, 1e9, 1e300, std::numeric_limits<double>::max()}) {
    const Box clip{.min = Eigen::Vector3d::Constant(-far), .max = Eigen::Vector3d::Constant(far)};
    const Box box = VoxelGrid(1.0, 10, clip, 0.005).box();
    EXPECT_EQ(box.min, of_root.box().min) << far;
    EXPECT_EQ(box.max, of_root.box().max) << far;
  }
}

TEST(VoxelGrid, PutsAVoxelsCentreIntoItsMiddle) {
  const VoxelGrid grid = octurn::grid();
  EXPECT_DOUBLE_EQ(grid.centre(0, 2), grid.voxel_side() / 2);
  EXPECT_DOUBLE_EQ(grid.centre(512, 0), grid.voxel_side() / 2);
  EXPECT_DOUBLE_EQ(grid.centre(0, 1), -0.5 + grid.voxel_side() / 2);
}

TEST(TsdfVolume, DropsLayersFromTheTopWhereItsBudgetEnds) {
  const std::size_t one_block = TsdfVolume(grid()).bytes();
  TsdfVolume volume(grid(), one_block);  // 511 bricks
  const Index3& size = volume.grid().size();
  ASSERT_GT(size.x * size.y * size.z, 1000);
  int refused = 0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        refused += volume.make({x, y, z}) == nullptr ? 1 : 0;
      }
    }
  }
  // The block of bricks, and the free list with the indices of the dropped bricks.
  EXPECT_LE(volume.bytes(), one_block + BlockPool<TsdfBrick>::block_items * sizeof(std::uint32_t));
  EXPECT_EQ(volume.layers().low, 0);
  EXPECT_LT(volume.layers().end, size.z);
  EXPECT_GT(refused, 0);
  for (int z = 0; z < size.z; ++z) {
    EXPECT_EQ(volume.find({1, 1, z}) != nullptr, z < volume.layers().end) << "layer " << z;
  }
}

TEST(TsdfVolume, ThrowsWhereNotEvenOneLayerFits) {
  const VoxelGrid wide(1.0, 10, {.min = {-0.2, -0.2, 0}, .max = {0.2, 0.2, 0.01}}, 0.005);
  TsdfVolume volume(wide, 0);
  EXPECT_THROW(
      {
        for (int y = 0; y < wide.size().y; ++y) {
          for (int x = 0; x < wide.size().x; ++x) {
            volume.make({x, y, 0});
          }
        }
      },
      OutOfBudget);
}

TEST(TsdfVolume, HoldsTheSameInSlabsAsAsAWhole) {
  const ConditionedDepth depth(rendered(hollowed_block({0.07, 0.05, 0.045}, 0.02), 1).read(0),
                               clip_box);
  TsdfVolume whole(grid());
  integrate(whole, depth);
  const int top = whole.grid().size().z;
  TsdfVolume slab(grid());
  int bricks = 0;
  for (int low = 0; low < top; low += 2) {
    slab.reset_to_slab(low, std::numeric_limits<std::size_t>::max());
    integrate(slab, depth);
    EXPECT_EQ(slab.layers().low, low);
    EXPECT_EQ(slab.layers().end, top);
    for (int z = 0; z < top; ++z) {
      for (int y = 0; y < whole.grid().size().y; ++y) {
        for (int x = 0; x < whole.grid().size().x; ++x) {
          const TsdfBrick* const expected = z < low ? nullptr : whole.find({x, y, z});
          const TsdfBrick* const brick = slab.find({x, y, z});
          ASSERT_EQ(brick != nullptr, expected != nullptr);
          if (brick != nullptr) {
            ++bricks;
            EXPECT_EQ(brick->distance, expected->distance);
            EXPECT_EQ(brick->weight, expected->weight);
            EXPECT_EQ(brick->free, expected->free);
          }
        }
      }
    }
  }
  EXPECT_GT(bricks, 100);
}

}  // namespace
}  // namespace octurn
