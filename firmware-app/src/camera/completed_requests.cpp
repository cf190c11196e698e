#include "camera/completed_requests.hpp"

#include <utility>

namespace octurn {

void CompletedRequests::add(libcamera::Request* request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
  }
  changed_.notify_all();
}

void CompletedRequests::disconnect() {
  {
    const std::lock_guard lock(mutex_);
    is_disconnected_ = true;
  }
  changed_.notify_all();
}

CompletedRequests::Outcome CompletedRequests::wait(const std::stop_token& stop,
                                                   std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  const bool changed = changed_.wait_until(
      lock, stop, deadline, [this] { return is_disconnected_ || !requests_.empty(); });
  if (stop.stop_requested()) {
    return Outcome::stopped;
  }
  if (is_disconnected_) {
    return Outcome::disconnected;
  }
  return changed ? Outcome::completed : Outcome::late;
}

std::vector<libcamera::Request*> CompletedRequests::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

}  // namespace octurn
