#include "process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <limits>
#include <system_error>
#include <thread>

#include "file_descriptor.hpp"
#include "octurn/error.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr auto poll_interval = std::chrono::milliseconds(5);
constexpr std::size_t max_output = std::size_t{16} << 20U;

/// Creates an anonymous file in memory for a program's output. Unlike a pipe, it never blocks the
/// program.
FileDescriptor make_output() {
  FileDescriptor file(::memfd_create("output", MFD_CLOEXEC));
  if (!file.is_open()) {
    throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  return file;
}

std::string read_content(const FileDescriptor& file) {
  const off_t end = ::lseek(file.number(), 0, SEEK_END);
  std::string content(std::min(static_cast<std::size_t>(std::max<off_t>(end, 0)), max_output), 0);
  const ssize_t got = ::pread(file.number(), content.data(), content.size(), 0);
  content.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return content;
}

/// Attributes of posix_spawn(3): standard output and error go to files, standard input is empty, no
/// signal is blocked, and the signals that `block_signals` ignores have their default action.
class SpawnSetup {
 public:
  SpawnSetup(const FileDescriptor& output, const FileDescriptor& errors) {
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files_, output.number(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&files_, errors.number(), STDERR_FILENO);
    ::posix_spawnattr_init(&attributes_);
    sigset_t signals;
    sigemptyset(&signals);
    ::posix_spawnattr_setsigmask(&attributes_, &signals);
    sigaddset(&signals, SIGPIPE);
    sigaddset(&signals, SIGXFSZ);
    ::posix_spawnattr_setsigdefault(&attributes_, &signals);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSetup() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;

  /// @throws Error "not-found"
  pid_t start(std::vector<std::string> command) const {
    std::vector<char*> words;
    for (std::string& word : command) {
      words.push_back(word.data());
    }
    words.push_back(nullptr);
    pid_t process = 0;
    if (const int error =
            ::posix_spawnp(&process, words[0], &files_, &attributes_, words.data(), environ);
        error != 0) {
      throw Error(ErrorCode::not_found,
                  command[0] + ": cannot be run: " + std::generic_category().message(error));
    }
    return process;
  }

 private:
  posix_spawn_file_actions_t files_ = {};
  posix_spawnattr_t attributes_ = {};
};

constexpr int large_block_bytes = 1 << 18;  // smaller than the blocks that store voxels

constexpr int kept_bytes = 1 << 25;  // glibc's maximum of M_MMAP_THRESHOLD on 64 bit

}  // namespace

ProgramResult run_program(const std::vector<std::string>& command, const std::stop_token& stop) {
  const FileDescriptor output = make_output();
  const FileDescriptor errors = make_output();
  const pid_t process = SpawnSetup(output, errors).start(command);
  int status = 0;
  while (::waitpid(process, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(poll_interval);
    if (stop.stop_requested()) {
      ::kill(process, SIGKILL);
      ::waitpid(process, &status, 0);
      throw Stopped{};
    }
  }
  return {.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          .output = read_content(output),
          .errors = read_content(errors)};
}

void keep_freed_memory() {
  ::mallopt(M_MMAP_THRESHOLD, kept_bytes);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

void return_freed_memory() { ::mallopt(M_MMAP_THRESHOLD, large_block_bytes); }

std::string host_name() {
  std::array<char, 65> name{};  // HOST_NAME_MAX and the terminating NUL
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

void notify_ready(const std::string& status) {
  ::sd_notify(0, ("READY=1\nSTATUS=" + status).c_str());
}

void notify_stopping() { ::sd_notify(0, "STOPPING=1"); }

std::optional<std::chrono::microseconds> watchdog_interval() {
  std::uint64_t microseconds = 0;
  return ::sd_watchdog_enabled(0, &microseconds) > 0
             ? std::optional(std::chrono::microseconds(microseconds))
             : std::nullopt;
}

void notify_alive() { ::sd_notify(0, "WATCHDOG=1"); }

}  // namespace octurn
