#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "doctor/finding.hpp"

namespace octurn {

/// What is wrong with the machine, told without being asked for: whoever wants to know while the
/// last look is old looks again for all. Any thread may call it.
class MachineWarnings {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// How often it is looked: a supply that fails is told soon, and a look reads a dozen files.
  static constexpr std::chrono::seconds interval{30};

  /// @param look  the findings of now that are a warning or a fault
  std::vector<Finding> get(Time now, const std::function<std::vector<Finding>()>& look);

 private:
  std::mutex mutex_ = {};  // guards what follows
  std::optional<Time> looked_ = {};
  std::vector<Finding> findings_ = {};
};

}  // namespace octurn
