#include "store/build_run.hpp"

#include <array>

namespace octurn {

Failure displaced_by_scan() {
  return {.code = ErrorCode::busy,
          .detail = "a scan has started",
          .hint = "Build again when it has ended."};
}

std::string describe(const BuildRun& run) {
  return "build " + std::to_string(run.number) + " of scan " + run.scan;
}

std::string_view to_string(BuildRun::State state) {
  constexpr std::array<std::string_view, 5> names{"waiting", "running", "finished", "failed",
                                                  "cancelled"};
  return names[static_cast<std::size_t>(state)];
}

}  // namespace octurn
