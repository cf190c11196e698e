#include "doctor/machine_warnings.hpp"

#include <gtest/gtest.h>

namespace octurn {
namespace {

TEST(MachineWarnings, AreLookedForAgainWhenTheyAreOld) {
  MachineWarnings warnings;
  std::vector<Finding> found{{.check = "supply"}};
  const auto look = [&] { return found; };
  const MachineWarnings::Time start{};
  EXPECT_EQ(warnings.get(start, look).size(), 1U);
  found.clear();
  EXPECT_EQ(warnings.get(start + MachineWarnings::interval / 2, look).size(), 1U);
  EXPECT_TRUE(warnings.get(start + MachineWarnings::interval, look).empty());
}

}  // namespace
}  // namespace octurn
