#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace octurn {

/// A connection that this process has accepted. civetweb does not give its sockets away, so they
/// are found among the open files of the process.
struct AcceptedSocket {
  int descriptor = -1;       ///< borrowed: whoever accepted it may close it at any moment
  ino_t inode = 0;           ///< tells it from a later one that has the same descriptor
  std::string address = {};  ///< of the peer, numeric, as getnameinfo(3) writes it
  int port = 0;              ///< of the peer
  bool has_unread = false;   ///< bytes have come that nobody has read yet
};

/// The connections that came in at this port and are still open, whatever their state.
/// @throws Error "no-descriptors"  if /proc/self/fd cannot be read
std::vector<AcceptedSocket> accepted_sockets(int local_port);

/// Has the kernel keep new connections at this port to itself until their first bytes have come, or
/// for this long (TCP_DEFER_ACCEPT, tcp(7)): so a client that says nothing takes no one's place.
/// @param time  0 hands them over at once again
void defer_accept(int local_port, std::chrono::seconds time);

/// How a connection is cut.
enum class Cut {
  reading,  ///< nothing more is heard from the client, which can still be answered
  finish,   ///< both ways; what is on its way to the client still arrives
  reset,    ///< both ways, and what the client has not taken is thrown away
};

/// Cuts a connection, unless it is closed already: whoever waits for it wakes up.
void shut_down(const AcceptedSocket& socket, Cut cut);

}  // namespace octurn
