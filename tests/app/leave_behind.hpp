#pragma once

#include <filesystem>
#include <functional>

#include "scan/scan_store.hpp"

namespace octurn {

/// A folder of scans, as a process that was killed would leave it when `leave` returns.
inline void leave_behind(const std::filesystem::path& data,
                         const std::function<void(ScanStore&)>& leave) {
  ScanStore store(data);
  leave(store);
}

}  // namespace octurn
