#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <thread>

#include "http/connection_table.hpp"

namespace octurn {

/// Keeps the clients of a server to their limits, by shutting sockets down under whoever waits for
/// them: a thread that civetweb lends to a slow client comes back at once. Any thread may call it.
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

  /// Whether a connection was cut as its client was too slow.
  bool is_cut(Key key);

  /// Ends a connection now, and throws away what its client has not taken.
  void reset(Key key);

  /// Another part of an exchange begins: its clock starts anew.
  void restart(Key key, Wait wait);

  /// The server waits for a client, as long as this lives.
  class Waiting {
   public:
    Waiting(ConnectionGuard& guard, Key key, Wait wait);
    ~Waiting();
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

    /// Bytes went to the client, or came.
    void add_bytes(std::uint64_t bytes);

   private:
    ConnectionGuard& guard_;
    Key key_;
  };

  /// Ends every connection, and those that come later.
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
