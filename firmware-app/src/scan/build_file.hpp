#pragma once

#include <filesystem>
#include <vector>

#include "scan/job.hpp"

namespace octurn {

/// The folder of a scan's builds: each has one of its own, named after its number, with `Scan.stl`
/// and `build.json`.
inline constexpr const char* builds_folder = "builds";

/// In the folder of a build that a scan of another pose made: the scan folder of all its poses.
inline constexpr const char* merged_folder = "scan";

/// In the folder of a build that another process makes: what that works on. Until there is a
/// `build.json` beside it, the folder is no build yet.
inline constexpr const char* task_file = "task.json";

/// Writes `folder/build.json`. @throws Error "disk-full", "write-failed"
void write_build(const std::filesystem::path& folder, const Build& build);

/// The builds of a scan, in order of their numbers. One that cannot be read is left out.
std::vector<Build> read_builds(const std::filesystem::path& scan);

/// One of them. @throws Error "job-malformed", "read-failed"
Build read_build(const std::filesystem::path& folder, int number);

/// The number that the folder of a build is named after; 0 if it is none.
int to_build_number(const std::string& name);

/// A number above those of all folders of builds.
int next_build_number(const std::filesystem::path& scan);

}  // namespace octurn
