#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "cluster/slurm_builds.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// Scripts in place of Slurm's programs, with the output that a test wants.
class SlurmScripts {
 public:
  SlurmScripts() {
    put(at("queue"), "");
    program("sbatch", "echo \"$@\" >>'" + at("submitted") + "'; echo '12;cluster'");
    program("squeue", "cat '" + at("queue") + "'");
    program("scancel", "echo \"$@\" >>'" + at("cancelled") + "'");
  }

  std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

  /// Writes a script in place of one of Slurm's programs.
  void program(const std::string& name, const std::string& does) const {
    put(at(name + ".new"), "#!/bin/sh\n" + does + "\n");
    std::filesystem::permissions(at(name + ".new"), std::filesystem::perms::owner_all);
    std::filesystem::rename(at(name + ".new"), at(name));
  }

  SlurmOptions options() const {
    return {.slurm = {.sbatch = at("sbatch"), .squeue = at("squeue"), .scancel = at("scancel")},
            .octurn = "/opt/octurn",
            .interval = std::chrono::milliseconds(1)};
  }

  /// Sets squeue's answer about the job of a build in `folder`.
  void say(const std::string& state, const std::string& reason, const std::filesystem::path& folder,
           const std::string& job = "12") const {
    put(at("queue.new"), job + "|" + state + "|" + reason + "|" + folder.string() + "//\n");
    std::filesystem::rename(at("queue.new"), at("queue"));
  }

  /// What the scripts have written to a file.
  std::string lines(const std::string& name) const {
    return std::filesystem::exists(at(name)) ? content_of(at(name)) : "";
  }

 private:
  TemporaryFolder folder_ = {};
};

}  // namespace octurn
