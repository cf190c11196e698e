#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "http/accepted_sockets.hpp"

namespace octurn {

/// What a connection waits for.
enum class Wait {
  head,    ///< the client's request line and headers
  server,  ///< this program makes the answer; that time does not count against the client
  body,    ///< a small body
  upload,  ///< a large body, at min_upload_rate
  reader,  ///< the client receives an answer, at min_answer_rate
  close,   ///< the client's end of the connection; its bytes are discarded
};

/// Limits for clients.
struct ConnectionLimits {
  std::size_t max_connections = 28;  ///< beyond it, connections that wait for clients are cut
  std::chrono::duration<double> patience = std::chrono::seconds(10);  ///< with each client
  double min_upload_rate = 100e3;                                     ///< bytes a second
  double min_answer_rate = 16e3;                                      ///< bytes a second
};

/// The connections of a server. Selects for shutdown those that keep the server waiting for too
/// long and, while there are too many, those with the most debt.
///
/// Each connection has a debt, in seconds. It grows with the time that the server waits for the
/// client, and every byte reduces it by 1 / rate, but not below 0: over any span of time a client
/// keeps up with the rate, or falls behind by its debt. Heads, small bodies and closing have a
/// deadline in place of a rate: their bytes reduce nothing. A debt above `patience` ends the
/// connection.
///
/// Not thread-safe. The time is a parameter, so that tests need no clock.
class ConnectionTable {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Key = ino_t;  ///< a socket's inode

  explicit ConnectionTable(const ConnectionLimits& limits) : limits_(limits) {}

  bool is_empty() const { return connections_.empty(); }

  /// Whether more than `max_connections` are open, which can be so even after `cut_all_due`.
  bool is_crowded() const { return count_held() > limits_.max_connections; }

  /// Adds new connections, and removes closed ones.
  void refresh(std::span<const AcceptedSocket> open, Time now);

  /// Records how late a sleeping thread woke up: on a busy machine a received head is parsed late,
  /// which is not the client's fault.
  void note_lateness(std::chrono::duration<double> lateness);

  /// Returns the connection of this peer, whose head was read; nothing if it has closed. From now
  /// on it waits for the server.
  std::optional<Key> claim(std::string_view address, int port, Time now);

  /// Changes what a connection waits for. Its debt stays.
  void set_wait(Key key, Wait wait, Time now);

  /// Clears a connection's debt, as another part of the exchange begins.
  void forgive(Key key, Time now);

  /// Counts bytes sent to or received from the client.
  void add_bytes(Key key, std::uint64_t bytes, Time now);

  /// Whether a connection was shut down, for reading or in both directions.
  bool is_cut(Key key) const;

  /// A connection to be shut down now.
  struct Ending {
    AcceptedSocket socket = {};
    Cut cut = Cut::finish;
  };

  /// Shuts down a connection whose answer will not be sent. Nothing if that was done before.
  std::optional<Ending> reset(Key key);

  /// Shuts down the connections that exceed their limits or the maximum number.
  std::vector<Ending> cut_all_due(Time now);

 private:
  struct Connection {
    AcceptedSocket socket = {};
    Time since = {};  // it appeared, or a thread last read its queued bytes
    Wait wait = Wait::head;
    double debt = 0;  // seconds, at the time `settled`
    Time settled = {};
    bool read_shut = false;  // shut for reading
    bool shut = false;       // shut wholly
  };

  static bool waits_for_server(const Connection& connection);
  std::optional<double> min_rate(Wait wait) const;
  void settle(Connection& connection, Time now, std::uint64_t bytes) const;
  std::optional<Cut> due(Connection& connection, Time now) const;
  std::size_t count_held() const;
  std::vector<Connection*> candidates(Time now);
  Connection* worst(Time now);

  ConnectionLimits limits_;
  std::chrono::duration<double> lateness_ = {};  // decaying maximum over the last polls
  std::unordered_map<Key, Connection> connections_ = {};
};

}  // namespace octurn
