#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string>

#include "file_descriptor.hpp"
#include "support/daemon.hpp"

namespace octurn {
namespace {

/// systemd's side of sd_notify(3): a socket that receives a daemon's state.
class Notifications {
 public:
  explicit Notifications(const std::filesystem::path& path)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
    std::ranges::copy(path.string(), address.sun_path);
    EXPECT_EQ(::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    const timeval patience{.tv_sec = 60, .tv_usec = 0};
    ::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }

  /// The next message; empty if there is none.
  std::string next() const {
    std::array<char, 4096> message{};
    const ssize_t length = ::recv(socket_.number(), message.data(), message.size(), 0);
    return {message.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
  }

 private:
  FileDescriptor socket_;
};

std::vector<std::string> as_service(const TemporaryFolder& folder) {
  std::vector<std::string> words{"/usr/bin/env",
                                 "NOTIFY_SOCKET=" + (folder.path() / "notify").string(),
                                 "WATCHDOG_USEC=300000"};
  const std::vector<std::string> command = Daemon::command(folder.path());
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

TEST(Service, TellsSystemdThatItIsReadyThatItLivesAndThatItEnds) {
  const TemporaryFolder folder;
  const Notifications systemd(folder.path() / "notify");
  Daemon daemon(as_service(folder));

  const std::string ready = systemd.next();
  EXPECT_TRUE(ready.starts_with("READY=1\nSTATUS=")) << ready;
  EXPECT_NE(ready.find(std::to_string(daemon.port())), std::string::npos) << ready;
  for (int sign = 0; sign < 3; ++sign) {
    EXPECT_EQ(systemd.next(), "WATCHDOG=1");
  }

  ::kill(daemon.program().process(), SIGTERM);
  std::string last;
  do {
    last = systemd.next();
  } while (last == "WATCHDOG=1");
  EXPECT_EQ(last, "STOPPING=1");
}

}  // namespace
}  // namespace octurn
