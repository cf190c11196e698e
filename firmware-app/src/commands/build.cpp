#include "cluster/external_build.hpp"
#include "commands/model_commands.hpp"
#include "process.hpp"
#include "signal_stop.hpp"

namespace octurn {

void build_ordered(const std::filesystem::path& folder) {
  return_freed_memory();
  const SignalStop signal;
  if (!build_task_in(folder, signal.token())) {
    throw_stopped("no model was written");
  }
}

}  // namespace octurn
