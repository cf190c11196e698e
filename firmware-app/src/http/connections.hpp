#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
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

/// Enforces limits on a server's clients by shutting down their sockets, so that a civetweb thread
/// that waits for a slow client returns at once. Thread-safe.
class ConnectionGuard {
 public:
  using Key = ConnectionTable::Key;
  static constexpr Key unknown = 0;  ///< of a connection that has closed already

  /// @param port  at which the server listens
  ConnectionGuard(int port, const ConnectionLimits& limits);

  /// Handles that a civetweb thread has taken a new connection: polls the sockets at once.
  void take_up();

  /// Returns the connection of this peer once its request head is read, or `unknown`.
  Key claim(std::string_view address, int port);

  /// Whether a connection was shut down, for reading or in both directions.
  bool is_cut(Key key);

  /// Resets a connection now; bytes that its client has not received are discarded.
  void reset(Key key);

  /// Begins the next part of an exchange, with a debt of 0.
  void restart(Key key, Wait wait);

  /// RAII scope in which the server waits for a client, so that the client's debt grows.
  class Waiting {
   public:
    Waiting(ConnectionGuard& guard, Key key, Wait wait);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    /// Counts bytes sent to or received from the client.
    void add_bytes(std::uint64_t bytes);

   private:
    ConnectionGuard& guard_;
    Key key_;
  };

  /// Ends all connections, and all later ones.
  void close();

 private:
  void watch(const std::stop_token& stop);
  void look();

  const int port_;
  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable_any changed_ = {};
  ConnectionTable table_;
  bool closed_ = false;
  std::jthread watch_ = {};  // the last member: it ends before what it uses
};

}  // namespace octurn
