#include "http/accepted_sockets.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <optional>

#include "file_descriptor.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

struct Closer {
  void operator()(DIR* folder) const { ::closedir(folder); }
};

/// The port of an IPv4 or IPv6 address; 0 for any other.
int to_port(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) {
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
  }
  if (address.ss_family == AF_INET6) {
    return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
  }
  return 0;
}

/// The inode number of a socket, unique among open sockets; nothing for any other file.
std::optional<ino_t> socket_inode(int descriptor) {
  struct ::stat info {};
  if (::fstat(descriptor, &info) != 0 || !S_ISSOCK(info.st_mode)) {
    return std::nullopt;
  }
  return info.st_ino;
}

bool is_at_port(int descriptor, int local_port) {
  sockaddr_storage local{};
  socklen_t size = sizeof local;
  return ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&local), &size) == 0 &&
         to_port(local) == local_port;
}

std::optional<AcceptedSocket> accepted_socket(int descriptor, int local_port) {
  const auto inode = socket_inode(descriptor);
  if (!inode || !is_at_port(descriptor, local_port)) {
    return std::nullopt;
  }
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  std::array<char, NI_MAXHOST> address{};
  if (::getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &size) != 0 ||
      ::getnameinfo(reinterpret_cast<const sockaddr*>(&peer), size, address.data(), address.size(),
                    nullptr, 0, NI_NUMERICHOST) != 0) {
    return std::nullopt;  // a listening socket, or its peer has closed
  }
  int unread = 0;  // bytes
  return AcceptedSocket{.descriptor = descriptor,
                        .inode = *inode,
                        .address = address.data(),
                        .port = to_port(peer),
                        .has_unread = ::ioctl(descriptor, FIONREAD, &unread) == 0 && unread > 0};
}

/// @throws Error "no-descriptors"
std::vector<int> open_descriptors() {
  const std::unique_ptr<DIR, Closer> folder(::opendir("/proc/self/fd"));
  if (!folder) {
    throw Error(ErrorCode::no_descriptors, "/proc/self/fd cannot be read", "Is /proc mounted?");
  }
  std::vector<int> descriptors;
  while (const dirent* const entry = ::readdir(folder.get())) {
    descriptors.push_back(std::atoi(entry->d_name));  // "." and "..": 0, which is no socket
  }
  return descriptors;
}

}  // namespace

std::vector<AcceptedSocket> accepted_sockets(int local_port) {
  std::vector<AcceptedSocket> sockets;
  for (const int descriptor : open_descriptors()) {
    if (auto socket = accepted_socket(descriptor, local_port)) {
      sockets.push_back(*std::move(socket));
    }
  }
  return sockets;
}

void defer_accept(int local_port, std::chrono::seconds time) {
  const auto seconds = static_cast<int>(time.count());
  for (const int descriptor : open_descriptors()) {
    int listens = 0;
    socklen_t size = sizeof listens;
    if (::getsockopt(descriptor, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 && listens != 0 &&
        is_at_port(descriptor, local_port)) {
      ::setsockopt(descriptor, IPPROTO_TCP, TCP_DEFER_ACCEPT, &seconds, sizeof seconds);
    }
  }
}

void shut_down(const AcceptedSocket& socket, Cut cut) {
  // The duplicate pins the open file: `descriptor` may be closed and reused at any moment.
  const FileDescriptor copy(::fcntl(socket.descriptor, F_DUPFD_CLOEXEC, 0));
  if (!copy.is_open() || socket_inode(copy.number()) != socket.inode) {
    return;
  }
  if (cut == Cut::reset) {
    const linger at_once{.l_onoff = 1, .l_linger = 0};
    ::setsockopt(copy.number(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }
  ::shutdown(copy.number(), cut == Cut::reading ? SHUT_RD : SHUT_RDWR);
}

}  // namespace octurn
