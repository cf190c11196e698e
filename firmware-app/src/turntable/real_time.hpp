#pragma once

namespace octurn {

/// Lets this thread run when its time has come, whatever else the system has to do.
/// @return 0, or why the system does not allow it, as errno has it
int ask_for_real_time_priority();

/// Has this thread share the processors with every other again.
void give_up_real_time_priority();

}  // namespace octurn
