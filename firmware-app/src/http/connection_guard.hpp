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
