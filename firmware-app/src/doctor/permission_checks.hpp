#pragma once

#include <filesystem>
#include <string>

#include "doctor/finding.hpp"

namespace octurn {

// Checks of what this program may use. A `root` is the folder that /dev and /sys are in: "/"
// outside of tests.

/// Whether the kernel sees a sensor on USB that Octurn knows, and whether it may be used.
Finding check_usb(const std::filesystem::path& root);

/// Whether the GPIO chips may be used.
Finding check_gpio_permission(const std::filesystem::path& root);

/// Whether scans can be kept in a folder, which need not exist yet.
Finding check_data_folder(const std::filesystem::path& data);

/// @param refusal  of the kernel to give a thread real-time priority; empty if it does
Finding check_real_time(const std::string& refusal);

}  // namespace octurn
