#pragma once

#include <filesystem>
#include <functional>

#include "store/scan_store.hpp"

namespace octurn {

/// Leaves a folder of scans as a process would that is killed when `leave` returns.
inline void leave_behind(const std::filesystem::path& data,
                         const std::function<void(ScanStore&)>& leave) {
  ScanStore store(data);
  leave(store);
}

}  // namespace octurn
