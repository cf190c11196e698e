#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>

namespace octurn {

/// Lets threads take chunks of work in any order, and hand them in one by one, from first to last.
class InOrder {
 public:
  explicit InOrder(std::size_t count) : count_(count) {}

  /// The next chunk that nobody has taken; nothing when all are taken, or one has failed.
  std::optional<std::size_t> take() {
    const std::lock_guard lock(mutex_);
    return taken_ < count_ && !failed_ ? std::optional(taken_++) : std::nullopt;
  }

  /// Calls `hand_in` when all chunks before this one were handed in. Not, if one has failed.
  template <typename HandIn>
  void in_turn(std::size_t chunk, HandIn hand_in) {
    std::unique_lock lock(mutex_);
    moved_on_.wait(lock, [&] { return next_ == chunk || failed_; });
    if (failed_) {
      return;
    }
    lock.unlock();  // only the thread whose turn it is gets here
    hand_in();
    lock.lock();
    ++next_;
    moved_on_.notify_all();
  }

  /// Lets nobody wait for a chunk that will not come.
  void fail() {
    const std::lock_guard lock(mutex_);
    failed_ = true;
    moved_on_.notify_all();
  }

 private:
  std::size_t count_;
  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable moved_on_ = {};
  std::size_t taken_ = 0;
  std::size_t next_ = 0;
  bool failed_ = false;
};

}  // namespace octurn
