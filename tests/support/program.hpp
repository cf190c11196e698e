#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "file_descriptor.hpp"
#include "support/patience.hpp"

namespace octurn {

/// The path of `octurn`, which is built beside the tests. A macro with the path would prevent
/// ccache from sharing the objects between clones.
inline std::string octurn_program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "octurn";
}

/// The path of the README's example of the library, which is built there, too.
inline std::string example_program() {
  return std::filesystem::path(octurn_program()).replace_filename("core_example");
}

/// Resource limits of a program (setrlimit).
struct ProgramLimits {
  std::optional<rlim_t> file_bytes = {};  ///< per file, to simulate a full disk
  std::optional<rlim_t> data_bytes = {};  ///< private memory, touched or not, with the stacks of
                                          ///< all threads but the first
};

/// A child process with its standard output and error. The destructor kills it if it still runs.
class Program {
 public:
  explicit Program(std::vector<std::string> command, const ProgramLimits& limits = {}) {
    std::array<FileDescriptor, 2> out = make_pipe();
    std::array<FileDescriptor, 2> error = make_pipe();
    std::vector<char*> arguments;
    for (std::string& argument : command) {
      arguments.push_back(argument.data());
    }
    arguments.push_back(nullptr);
    ::malloc_trim(0);  // what earlier tests have freed is not the program's: see peak_memory_bytes
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(out[1].number(), STDOUT_FILENO);
      ::dup2(error[1].number(), STDERR_FILENO);
      set_limit(RLIMIT_FSIZE, limits.file_bytes);
      set_limit(RLIMIT_DATA, limits.data_bytes);
      ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    out_ = std::move(out[0]);
    error_ = std::move(error[0]);
  }

  ~Program() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t process() const { return process_; }

  void send_signal(int signal) const { ::kill(process_, signal); }

  /// Reads a line of its standard output; empty at the end, or if none comes within `patience`.
  std::string read_line() {
    std::string line;
    char letter = 0;
    pollfd ready{.fd = out_.number(), .events = POLLIN, .revents = 0};
    constexpr int limit_ms = std::chrono::milliseconds(patience).count();
    while (::poll(&ready, 1, limit_ms) == 1 && ::read(out_.number(), &letter, 1) == 1) {
      if (letter == '\n') {
        break;
      }
      line += letter;
    }
    return line;
  }

  /// Waits for its end. @return its exit status, or minus the signal that ended it
  int wait() {
    return wait([&](std::string_view part) { output_ += part; });
  }

  /// Waits for its end, and passes its output to `output` piece by piece instead of keeping it.
  template <typename Sink>
  int wait(Sink output) {
    read_to_end(output);
    int status = 0;
    ::wait4(std::exchange(process_, -1), &status, 0, &usage_);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  /// Its standard output, complete after `wait`.
  const std::string& output() const { return output_; }
  const std::string& errors() const { return errors_; }

  /// Peak resident memory, available after `wait`, as in `time -v`. The kernel counts from the
  /// fork, so it is at least the test program's own resident memory at that time.
  std::size_t peak_memory_bytes() const {
    return static_cast<std::size_t>(usage_.ru_maxrss) * 1024;  // Linux counts in kilobytes
  }

 private:
  static void set_limit(int resource, const std::optional<rlim_t>& most) {
    if (most) {
      const rlimit limit{.rlim_cur = *most, .rlim_max = *most};
      ::setrlimit(static_cast<__rlimit_resource>(resource), &limit);
    }
  }

  static std::array<FileDescriptor, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw std::system_error(errno, std::generic_category(), "pipe");
    }
    return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
  }

  template <typename Sink>
  void read_to_end(Sink& output) {
    std::array<pollfd, 2> ready{pollfd{.fd = out_.number(), .events = POLLIN, .revents = 0},
                                pollfd{.fd = error_.number(), .events = POLLIN, .revents = 0}};
    std::vector<char> part(std::size_t{64} * 1024);
    while (ready[0].fd >= 0 || ready[1].fd >= 0) {
      ::poll(ready.data(), ready.size(), -1);
      for (std::size_t i = 0; i < ready.size(); ++i) {
        if (ready[i].fd < 0 || ready[i].revents == 0) {
          continue;
        }
        const ssize_t got = ::read(ready[i].fd, part.data(), part.size());
        if (got <= 0) {
          ready[i].fd = -1;
        } else if (const std::string_view text(part.data(), static_cast<std::size_t>(got));
                   i == 0) {
          output(text);
        } else {
          errors_ += text;
        }
      }
    }
  }

  pid_t process_ = -1;
  FileDescriptor out_ = {};
  FileDescriptor error_ = {};
  std::string output_ = {};
  std::string errors_ = {};
  rusage usage_ = {};
};

}  // namespace octurn
