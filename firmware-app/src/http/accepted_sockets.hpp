#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace octurn {

/// A connection that this process has accepted. civetweb does not expose its sockets, so they are
/// found among the open files of the process.
struct AcceptedSocket {
  int descriptor = -1;       ///< borrowed: civetweb may close it at any moment
  ino_t inode = 0;           ///< distinguishes it from a later one with the same descriptor
  std::string address = {};  ///< of the peer, numeric, as getnameinfo(3) writes it
  int port = 0;              ///< of the peer
  bool has_unread = false;   ///< received bytes were not read yet
};

/// The open connections that were accepted at this port, in any state.
/// @throws Error "no-descriptors"  if /proc/self/fd cannot be read
std::vector<AcceptedSocket> accepted_sockets(int local_port);

/// Has the kernel hold back new connections at this port until their first bytes arrive, or for
/// this long (TCP_DEFER_ACCEPT, tcp(7)), so that a silent client does not occupy a thread.
/// @param time  0 switches this off
void defer_accept(int local_port, std::chrono::seconds time);

/// How a connection is shut down.
enum class Cut {
  reading,  ///< for reading only: the client can still be answered
  finish,   ///< both ways; bytes that were sent still arrive
  reset,    ///< both ways; bytes that the client has not received are discarded
};

/// Shuts a connection down, unless it is closed already. A thread that waits for it wakes up.
void shut_down(const AcceptedSocket& socket, Cut cut);

}  // namespace octurn
