#pragma once

#include <filesystem>
#include <vector>

#include "store/job.hpp"

namespace octurn {

/// The folder of a scan's builds. Each build has a subfolder, named after its number, with
/// `Scan.stl` and `build.json`.
inline constexpr const char* builds_folder = "builds";

/// The folder of a removed pose for the builds of its earlier scan that merge it. They return with
/// the pose from the bin.
inline constexpr const char* removed_builds_folder = "removed_builds";

/// Subfolder of a build that merges several poses: a scan folder with the snapshots of all of them.
inline constexpr const char* merged_folder = "scan";

/// The task file in the folder of a build that another process makes. The folder is not a build
/// until it also has a `build.json`.
inline constexpr const char* task_file = "task.json";

/// Writes `folder/build.json`. @throws Error "disk-full", "write-failed"
void write_build(const std::filesystem::path& folder, const Build& build);

/// Reads the builds of a scan, sorted by number. Unreadable ones are logged and left out.
std::vector<Build> read_builds(const std::filesystem::path& scan);

/// Reads the build in one folder. @throws Error "job-malformed", "read-failed"
Build read_build(const std::filesystem::path& folder, int number);

/// The number in the name of a build's folder; 0 if it is not such a folder.
int to_build_number(const std::string& name);

/// The smallest number above those of all builds' folders.
int next_build_number(const std::filesystem::path& scan);

}  // namespace octurn
