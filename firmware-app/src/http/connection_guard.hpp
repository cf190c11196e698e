#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <thread>

#include "http/connection_table.hpp"

namespace octurn {

/// Enforces limits on a server's clients by shutting down their sockets, so that a civetweb thread
/// that waits for a slow client returns at once. Thread-safe.
class ConnectionGuard {
 public:
  using Key = ConnectionTable::Key;
  static constexpr Key unknown = 0;  ///< of a connection that has closed already

  /// @param port  at which the server listens
  ConnectionGuard(int port, const ConnectionLimits& limits);

  /// A connection has been given a thread.
  void take_up();

  /// The connection of this peer, whose head is read.
  Key claim(std::string_view address, int port);

  /// Whether a connection was shut down because its client was too slow.
  bool is_cut(Key key);

  /// Resets a connection now; bytes that its client has not received are discarded.
  void reset(Key key);

  /// Begins another part of an exchange: its clock restarts.
  void restart(Key key, Wait wait);

  /// During its lifetime the server waits for a client.
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
