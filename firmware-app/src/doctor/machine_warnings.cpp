#include "doctor/machine_warnings.hpp"

namespace octurn {

std::vector<Finding> MachineWarnings::get(Time now,
                                          const std::function<std::vector<Finding>()>& look) {
  const std::lock_guard lock(mutex_);
  if (!looked_ || now - *looked_ >= interval) {
    findings_ = look();
    looked_ = now;
  }
  return findings_;
}

}  // namespace octurn
