#pragma once

#include <filesystem>
#include <string>

#include "doctor/finding.hpp"

namespace octurn {

// Checks of this program's permissions. `root` is the folder with /dev and /sys: "/" except in
// tests.

/// Whether a supported sensor is on USB, and this user may open it.
Finding check_usb(const std::filesystem::path& root);

/// Whether this user may open the GPIO chips.
Finding check_gpio_permission(const std::filesystem::path& root);

/// Whether this user may write into the data folder, or create it.
Finding check_data_folder(const std::filesystem::path& data);

/// Whether the stepper's thread gets real-time priority.
/// @param refusal  the kernel's reason against it; empty if it allows it
Finding check_real_time(const std::string& refusal);

}  // namespace octurn
