#include "http/connection_table.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace octurn {
namespace {

// Debt that a retransmitted packet does not explain: clients above it are cut first.
constexpr double noticeable_debt = 1;  // seconds

// Maximum time from the arrival of a whole head until a thread parses it. With 10 ms a visitor was
// cut as the only candidate, while others filled the queue.
constexpr std::chrono::milliseconds reading_time(100);

// Scheduling delays allowed per head: on a busy machine a thread is preempted more than once.
constexpr int turns_of_reading = 10;

// Upper bound of the reading time, however busy the machine is.
constexpr std::chrono::milliseconds max_reading_time(1000);

// Decay of the lateness per poll: a machine that was busy may be so again.
constexpr double remembered_lateness = 0.9;

/// A slow reader is reset: its unsent bytes would stay in kernel memory for minutes.
Cut final_cut(Wait wait) { return wait == Wait::reader ? Cut::reset : Cut::finish; }

}  // namespace

void ConnectionTable::refresh(std::span<const AcceptedSocket> open, Time now) {
  std::unordered_map<Key, Connection> still_open;
  for (const AcceptedSocket& socket : open) {
    const auto known = connections_.find(socket.inode);
    if (known != connections_.end()) {
      if (known->second.socket.has_unread && !socket.has_unread) {
        known->second.since = now;
      }
      known->second.socket.has_unread = socket.has_unread;
      still_open.insert(connections_.extract(known));
    } else {
      still_open.emplace(socket.inode, Connection{.socket = socket, .since = now, .settled = now});
    }
  }
  connections_ = std::move(still_open);
}

void ConnectionTable::note_lateness(std::chrono::duration<double> lateness) {
  lateness_ = std::max({lateness, remembered_lateness * lateness_, decltype(lateness_)(0)});
}

std::optional<ConnectionTable::Key> ConnectionTable::claim(std::string_view address, int port,
                                                           Time now) {
  const auto found = std::ranges::find_if(connections_, [&](const auto& entry) {
    const AcceptedSocket& socket = entry.second.socket;
    return socket.port == port && socket.address == address;
  });
  if (found == connections_.end()) {
    return std::nullopt;
  }
  set_wait(found->first, Wait::server, now);
  forgive(found->first, now);
  return found->first;
}

/// A connection whose head has arrived unread is in the queue for a thread, as every visitor is
/// while others occupy all threads.
bool ConnectionTable::waits_for_server(const Connection& connection) {
  return connection.wait == Wait::server ||
         (connection.wait == Wait::head && connection.socket.has_unread);
}

/// The minimum rate in bytes a second; nothing if only the deadline applies.
std::optional<double> ConnectionTable::min_rate(Wait wait) const {
  switch (wait) {
    case Wait::upload:
      return limits_.min_upload_rate;
    case Wait::reader:
      return limits_.min_answer_rate;
    default:
      return std::nullopt;
  }
}

void ConnectionTable::settle(Connection& connection, Time now, std::uint64_t bytes) const {
  if (!waits_for_server(connection)) {
    connection.debt += std::chrono::duration<double>(now - connection.settled).count();
  }
  if (const auto rate = min_rate(connection.wait)) {
    connection.debt = std::max(0.0, connection.debt - static_cast<double>(bytes) / *rate);
  }
  connection.settled = now;
}

void ConnectionTable::set_wait(Key key, Wait wait, Time now) {
  if (const auto found = connections_.find(key); found != connections_.end()) {
    settle(found->second, now, 0);
    found->second.wait = wait;
  }
}

void ConnectionTable::forgive(Key key, Time now) {
  if (const auto found = connections_.find(key); found != connections_.end()) {
    found->second.debt = 0;
    found->second.settled = now;
  }
}

void ConnectionTable::add_bytes(Key key, std::uint64_t bytes, Time now) {
  if (const auto found = connections_.find(key); found != connections_.end()) {
    settle(found->second, now, bytes);
  }
}

bool ConnectionTable::is_cut(Key key) const {
  const auto found = connections_.find(key);
  return found != connections_.end() && (found->second.read_shut || found->second.shut);
}

std::optional<ConnectionTable::Ending> ConnectionTable::reset(Key key) {
  const auto found = connections_.find(key);
  if (found == connections_.end() || found->second.shut) {
    return std::nullopt;
  }
  found->second.shut = true;
  return Ending{.socket = found->second.socket, .cut = Cut::reset};
}

/// Decides how a connection over its limit is cut. One that sends a body is first shut down for
/// reading only, and has as much patience again to receive an error.
std::optional<Cut> ConnectionTable::due(Connection& connection, Time now) const {
  if (connection.shut) {
    return std::nullopt;
  }
  settle(connection, now, 0);
  const double patience = limits_.patience.count();
  const bool sends_body = connection.wait == Wait::body || connection.wait == Wait::upload;
  if (connection.debt > (sends_body ? 2 : 1) * patience) {
    connection.shut = true;
    return final_cut(connection.wait);
  }
  if (sends_body && !connection.read_shut && connection.debt > patience) {
    connection.read_shut = true;
    return Cut::reading;
  }
  return std::nullopt;
}

std::vector<ConnectionTable::Ending> ConnectionTable::cut_all_due(Time now) {
  std::vector<Ending> endings;
  for (auto& [key, connection] : connections_) {
    if (const auto cut = due(connection, now)) {
      endings.push_back({.socket = connection.socket, .cut = *cut});
    }
  }
  for (std::size_t held = count_held(); held > limits_.max_connections; --held) {
    Connection* const connection = worst(now);
    if (connection == nullptr) {
      break;  // all connections wait for the server, or are new
    }
    connection->shut = true;
    endings.push_back({.socket = connection->socket, .cut = final_cut(connection->wait)});
  }
  return endings;
}

std::size_t ConnectionTable::count_held() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(connections_, [](const auto& entry) { return !entry.second.shut; }));
}

/// The connections that have waited for their clients for at least the reading time.
std::vector<ConnectionTable::Connection*> ConnectionTable::candidates(Time now) {
  const auto reading = std::min<std::chrono::duration<double>>(
      reading_time + turns_of_reading * lateness_, max_reading_time);
  std::vector<Connection*> waiting;
  for (auto& [key, connection] : connections_) {
    if (!connection.shut && !waits_for_server(connection) && now - connection.since >= reading) {
      waiting.push_back(&connection);
    }
  }
  return waiting;
}

/// The candidate with the most debt; if no debt is noticeable, the oldest candidate of the address
/// with the most connections. Null if there is none.
ConnectionTable::Connection* ConnectionTable::worst(Time now) {
  const std::vector<Connection*> waiting = candidates(now);
  if (waiting.empty()) {
    return nullptr;
  }
  Connection* const deepest = *std::ranges::max_element(waiting, {}, &Connection::debt);
  if (deepest->debt > noticeable_debt) {
    return deepest;
  }
  std::map<std::string_view, std::size_t> held;
  for (const auto& [key, connection] : connections_) {
    held[connection.socket.address] += connection.shut ? 0 : 1;
  }
  return *std::ranges::max_element(waiting, {}, [&](const Connection* connection) {
    return std::pair(held[connection->socket.address], -connection->since.time_since_epoch());
  });
}

}  // namespace octurn
