#include "cluster/slurm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>

#include "octurn/units.hpp"
#include "run_program.hpp"

namespace octurn {
namespace {

// Output format of `squeue`. The folder is the last field, as it may contain the separator and even
// newlines. Two slashes end a job, as no canonical path contains them.
constexpr const char* listed = "%i|%T|%r|%Z//";
constexpr std::string_view end_of_job = "//\n";
constexpr std::size_t listed_fields = 4;

constexpr std::array<std::string_view, 10> ended{
    "BOOT_FAIL", "CANCELLED",     "COMPLETED", "DEADLINE", "FAILED",
    "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "REVOKED",  "TIMEOUT"};
constexpr std::array<std::string_view, 6> begun{"COMPLETING", "RUNNING",   "SIGNALING",
                                                "STAGE_OUT",  "SUSPENDED", "STOPPED"};

/// A reason code of Slurm's, and its explanation.
struct Meaning {
  std::string_view word;
  const char* text;
};

constexpr std::array reasons{
    Meaning{"None", "Slurm has not looked at it yet"},
    Meaning{"Resources", "it waits for processors or memory"},
    Meaning{"Priority", "other jobs come before it"},
    Meaning{"BeginTime", "Slurm runs it again in some minutes"},
    Meaning{"JobHeldUser", "it is held, until scontrol release lets it go"},
    Meaning{"JobHeldAdmin", "an administrator holds it"},
    Meaning{"PartitionDown", "its partition takes no jobs now"},
    Meaning{"PartitionInactive", "its partition starts no jobs now"},
    Meaning{"PartitionTimeLimit", "it asks for more time than its partition gives"},
    Meaning{"ReqNodeNotAvail", "the machines that it needs are not there now"},
    Meaning{"Reservation", "the machines are reserved"},
};

struct End {
  std::string_view state;
  ErrorCode code;
  const char* detail;
  const char* hint;
};

constexpr std::array ends{
    End{"CANCELLED", ErrorCode::interrupted, "its job was cancelled", "Build again."},
    End{"NODE_FAIL", ErrorCode::interrupted, "the machine of its job failed", "Build again."},
    End{"BOOT_FAIL", ErrorCode::interrupted, "the machine of its job did not start",
        "Build again."},
    End{"OUT_OF_MEMORY", ErrorCode::memory_limit, "its job needed more memory than it had",
        "Set a lower memory_limit_mb, or take coarser leaves."},
    End{"PREEMPTED", ErrorCode::interrupted, "its job had to make room for another",
        "Build again."},
    End{"TIMEOUT", ErrorCode::interrupted, "its job took longer than Slurm lets it",
        "Give it more time in SBATCH_TIMELIMIT, or take coarser leaves."},
};

bool is_among(std::string_view word, const auto& words) {
  return std::ranges::find(words, word) != words.end();
}

/// Returns the last line that is not empty.
std::string last_line(const std::string& text) {
  std::string last;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) {
      last = line;
    }
  }
  return last;
}

/// Runs one of Slurm's programs. @return its output
std::string run(const std::vector<std::string>& command, const std::stop_token& stop) {
  ProgramResult result;
  try {
    result = run_program(command, stop);
  } catch (const Error& error) {
    throw Error(ErrorCode::interrupted, std::string("Slurm: ") + error.what(),
                "Slurm has to be installed here.");
  }
  if (result.status != 0) {
    const std::string said = last_line(result.errors);
    throw Error(
        ErrorCode::interrupted,
        "Slurm: " +
            (said.empty() ? command[0] + " ended with " + std::to_string(result.status) : said),
        "Its slurmctld has to run, and a node to have what the settings threads and "
        "memory_limit_mb ask for.");
  }
  return std::move(result.output);
}

SlurmJob to_slurm_job(std::string_view text) {
  std::array<std::string, listed_fields> parts;
  for (std::size_t i = 0; i < listed_fields; ++i) {
    const std::size_t end = i + 1 < listed_fields ? text.find('|') : text.size();
    parts[i] = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), parts[i].size() + 1));
  }
  return {.id = std::move(parts[0]),
          .state = std::move(parts[1]),
          .reason = std::move(parts[2]),
          .folder = std::move(parts[3])};
}

}  // namespace

bool SlurmJob::has_begun() const { return is_among(state, begun); }

bool SlurmJob::has_ended() const { return is_among(state, ended); }

void Slurm::expect_programs() const {
  for (const std::string& program : {sbatch, squeue, scancel}) {
    try {
      run_program({program, "--version"}, {});
    } catch (const Error& error) {
      throw Error(ErrorCode::bad_settings, std::string("--builds-by slurm: ") + error.what(),
                  "Install Slurm's programs, on Debian slurm-client, or leave --builds-by out.");
    }
  }
}

std::string Slurm::submit(const SlurmRequest& request, const std::stop_token& stop) const {
  std::vector<std::string> command{sbatch,
                                   "--parsable",
                                   "--job-name=" + std::string(build_job_name),
                                   "--chdir=" + request.folder.string(),
                                   "--output=job.log",
                                   "--open-mode=append",
                                   "--nodes=1",
                                   "--ntasks=1",
                                   "--cpus-per-task=" + std::to_string(request.processors)};
  if (request.memory_bytes > 0) {
    const double mb = mb_from_bytes(static_cast<double>(request.memory_bytes));
    command.push_back("--mem=" + std::to_string(std::lround(std::ceil(mb))) + "M");
  }
  command.push_back(request.script);
  command.insert(command.end(), request.arguments.begin(), request.arguments.end());
  const std::string output = run(command, stop);
  std::string id = output.substr(0, output.find_first_of(";\n"));  // "12", or "12;cluster"
  if (id.empty() || !std::ranges::all_of(id, [](char c) { return c >= '0' && c <= '9'; })) {
    throw Error(ErrorCode::interrupted, "Slurm: " + sbatch + " did not print the job's number",
                "Check whether squeue lists the job.");
  }
  return id;
}

std::vector<SlurmJob> Slurm::list(const std::stop_token& stop) const {
  const std::string output =
      run({squeue, "--me", "--noheader", "--states=all", "--name=" + std::string(build_job_name),
           "--format=" + std::string(listed)},
          stop);
  std::vector<SlurmJob> jobs;
  std::string_view left = output;
  for (auto end = left.find(end_of_job); end != left.npos; end = left.find(end_of_job)) {
    jobs.push_back(to_slurm_job(left.substr(0, end)));
    left.remove_prefix(end + end_of_job.size());
  }
  return jobs;
}

void Slurm::cancel(const std::string& id, const std::stop_token& stop) const {
  run({scancel, id}, stop);
}

std::string describe_wait(const SlurmJob& job) {
  const auto* const found = std::ranges::find(reasons, job.reason, &Meaning::word);
  return found != reasons.end() ? found->text : "Slurm: " + job.reason;
}

Failure describe_end(const SlurmJob& job) {
  const auto* const found = std::ranges::find(ends, job.state, &End::state);
  if (found != ends.end()) {
    return {.code = found->code,
            .detail = std::string(found->detail) + " (Slurm's job " + job.id + ")",
            .hint = found->hint};
  }
  return {.code = ErrorCode::interrupted,
          .detail = "Slurm's job " + job.id + " has ended without a model" +
                    (job.state.empty() ? "" : ": " + job.state) +
                    (job.reason == "None" ? "" : ", " + job.reason),
          .hint = "Look into slurmd's log of the job's machine, and build again."};
}

}  // namespace octurn
