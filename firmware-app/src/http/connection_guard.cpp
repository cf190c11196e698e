#include "http/connection_guard.hpp"

#include <chrono>

#include "log.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

// Polling interval of the debts, short relative to a patience of seconds.
constexpr std::chrono::milliseconds tick(100);

// Polling interval while there are too many connections, as clients in the queue wait for it.
constexpr std::chrono::milliseconds crowded_tick(10);

}  // namespace

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
