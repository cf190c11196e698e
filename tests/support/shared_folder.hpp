#pragma once

#include <cstdlib>
#include <filesystem>

namespace octurn {

/// Sample data that some tests can use and none needs: the folder that OCTURN_SHARED names, or
/// `shared` beside the project's.
inline std::filesystem::path shared_folder() {
  const char* named = std::getenv("OCTURN_SHARED");
  return named != nullptr ? std::filesystem::path(named) : std::filesystem::path(OCTURN_SHARED);
}

}  // namespace octurn
