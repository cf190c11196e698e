#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "file_descriptor.hpp"

namespace octurn {

/// A program that a test has started, with its two outputs. Killed, if it still runs, when the test
/// ends.
class Program {
 public:
  /// @param most_file_bytes  a limit on the size of the files it writes: a disk that is full
  explicit Program(std::vector<std::string> command, std::optional<rlim_t> most_file_bytes = {}) {
    std::array<FileDescriptor, 2> out = make_pipe();
    std::array<FileDescriptor, 2> error = make_pipe();
    std::vector<char*> arguments;
    for (std::string& argument : command) {
      arguments.push_back(argument.data());
    }
    arguments.push_back(nullptr);
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(out[1].number(), STDOUT_FILENO);
      ::dup2(error[1].number(), STDERR_FILENO);
      if (most_file_bytes) {
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{.rlim_cur = *most_file_bytes, .rlim_max = *most_file_bytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
      }
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

  void send_signal(int signal) const { ::kill(process_, signal); }

  /// The next line of its standard output; empty at the end, or if none comes for 20 s.
  std::string read_line() {
    std::string line;
    char letter = 0;
    pollfd ready{.fd = out_.number(), .events = POLLIN, .revents = 0};
    while (::poll(&ready, 1, 20'000) == 1 && ::read(out_.number(), &letter, 1) == 1) {
      if (letter == '\n') {
        break;
      }
      line += letter;
    }
    return line;
  }

  /// Waits for its end. @return its exit status, or minus the signal that ended it
  int wait() {
    read_to_end();
    int status = 0;
    ::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  /// What it has written, after `wait`.
  const std::string& output() const { return output_; }
  const std::string& errors() const { return errors_; }

 private:
  static std::array<FileDescriptor, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw std::system_error(errno, std::generic_category(), "pipe");
    }
    return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
  }

  void read_to_end() {
    std::array<pollfd, 2> ready{pollfd{.fd = out_.number(), .events = POLLIN, .revents = 0},
                                pollfd{.fd = error_.number(), .events = POLLIN, .revents = 0}};
    std::array<std::string*, 2> texts{&output_, &errors_};
    std::array<char, 4096> part{};
    while (ready[0].fd >= 0 || ready[1].fd >= 0) {
      ::poll(ready.data(), ready.size(), -1);
      for (std::size_t i = 0; i < ready.size(); ++i) {
        if (ready[i].fd < 0 || ready[i].revents == 0) {
          continue;
        }
        const ssize_t got = ::read(ready[i].fd, part.data(), part.size());
        if (got <= 0) {
          ready[i].fd = -1;
        } else {
          texts[i]->append(part.data(), static_cast<std::size_t>(got));
        }
      }
    }
  }

  pid_t process_ = -1;
  FileDescriptor out_ = {};
  FileDescriptor error_ = {};
  std::string output_ = {};
  std::string errors_ = {};
};

}  // namespace octurn
