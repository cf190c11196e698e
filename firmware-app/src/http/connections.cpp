#include "http/connections.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "file_descriptor.hpp"
#include "log.hpp"
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

using Clock = std::chrono::steady_clock;

// Polling interval of the debts, short relative to a patience of seconds.
constexpr std::chrono::milliseconds tick(100);

// Polling interval while there are too many connections, as clients in the queue wait for it.
constexpr std::chrono::milliseconds crowded_tick(10);

/// The open connections that were accepted at this port, in any state.
/// @throws Error "no-descriptors"  if /proc/self/fd cannot be read
std::vector<AcceptedSocket> accepted_sockets(int local_port) {
  std::vector<AcceptedSocket> sockets;
  for (const int descriptor : open_descriptors()) {
    if (auto socket = accepted_socket(descriptor, local_port)) {
      sockets.push_back(*std::move(socket));
    }
  }
  return sockets;
}

}  // namespace

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

namespace {

/// Shuts a connection down, unless it is closed already. A thread that waits for it wakes up.
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

ConnectionGuard::ConnectionGuard(int port, const ConnectionLimits& limits)
    : port_(port), table_(limits), watch_([this](const std::stop_token& stop) { watch(stop); }) {}

void ConnectionGuard::take_up() {
  const std::lock_guard lock(mutex_);
  look();
  changed_.notify_all();
}

ConnectionGuard::Key ConnectionGuard::claim(std::string_view address, int port) {
  const std::lock_guard lock(mutex_);
  return table_.claim(address, port, Clock::now()).value_or(unknown);
}

bool ConnectionGuard::is_cut(Key key) {
  const std::lock_guard lock(mutex_);
  return table_.is_cut(key);
}

void ConnectionGuard::reset(Key key) {
  const std::lock_guard lock(mutex_);
  if (const auto ending = table_.reset(key)) {
    shut_down(ending->socket, ending->cut);
  }
}

void ConnectionGuard::restart(Key key, Wait wait) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  table_.set_wait(key, wait, now);
  table_.forgive(key, now);
}

void ConnectionGuard::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  look();
}

/// Polls the sockets and shuts down those that are due. The caller holds the mutex.
void ConnectionGuard::look() try {
  const std::vector<AcceptedSocket> open = accepted_sockets(port_);
  const auto now = Clock::now();
  table_.refresh(open, now);
  for (const auto& [socket, cut] : table_.cut_all_due(now)) {
    shut_down(socket, cut);
  }
  for (const AcceptedSocket& socket : open) {
    if (closed_) {
      shut_down(socket, Cut::finish);
    }
  }
} catch (const Error& error) {
  log::error("http", error.what());  // such as too many open files; the next poll may succeed
}

void ConnectionGuard::watch(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait(lock, stop, [this] { return !table_.is_empty(); });
    const auto due = Clock::now() + (table_.is_crowded() ? crowded_tick : tick);
    changed_.wait_until(lock, stop, due, [] { return false; });
    table_.note_lateness(Clock::now() - due);
    look();
  }
}

ConnectionGuard::Waiting::Waiting(ConnectionGuard& guard, Key key, Wait wait)
    : guard_(guard), key_(key) {
  const std::lock_guard lock(guard_.mutex_);
  guard_.table_.set_wait(key_, wait, Clock::now());
}

ConnectionGuard::Waiting::~Waiting() {
  const std::lock_guard lock(guard_.mutex_);
  guard_.table_.set_wait(key_, Wait::server, Clock::now());
}

void ConnectionGuard::Waiting::add_bytes(std::uint64_t bytes) {
  const std::lock_guard lock(guard_.mutex_);
  guard_.table_.add_bytes(key_, bytes, Clock::now());
}

}  // namespace octurn
