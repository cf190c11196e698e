#pragma once

#include <libcamera/libcamera.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <vector>

namespace octurn {

/// Requests that libcamera's thread has completed, on their way to the thread that reads.
class CompletedRequests {
 public:
  enum class Outcome { completed, stopped, late, disconnected };

  /// Called by libcamera's thread.
  void add(libcamera::Request* request);
  void disconnect();

  /// Waits until there is a request; `late` if there is none at the deadline.
  Outcome wait(const std::stop_token& stop, std::chrono::steady_clock::time_point deadline);

  /// All that are there, the oldest first.
  std::vector<libcamera::Request*> take();

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<libcamera::Request*> requests_ = {};
  bool is_disconnected_ = false;
};

}  // namespace octurn
