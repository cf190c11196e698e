#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <utility>

namespace octurn {

/// The latest value of a published state, with any number of readers. A reader gets an immutable
/// value that stays valid when the state is replaced. Thread-safe.
template <typename Value>
class Latest {
 public:
  std::shared_ptr<const Value> get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

  void set(Value value) {
    auto next = std::make_shared<const Value>(std::move(value));
    {
      const std::lock_guard lock(mutex_);
      value_.swap(next);
    }
    changed_.notify_all();
  }

  /// Atomically replaces the value by a copy that `change` has modified.
  template <typename Change>
  void update(Change change) {
    {
      const std::lock_guard lock(mutex_);
      Value next = *value_;
      change(next);
      value_ = std::make_shared<const Value>(std::move(next));
    }
    changed_.notify_all();
  }

  /// Waits until the value satisfies the condition, for at most `timeout`.
  /// @return the latest value in either case
  template <typename Wanted>
  std::shared_ptr<const Value> wait(const std::stop_token& stop, std::chrono::milliseconds timeout,
                                    Wanted wanted) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, timeout, [&] { return wanted(*value_); });
    return value_;
  }

 private:
  mutable std::mutex mutex_;  // guards the pointer value_: the pointee never changes
  mutable std::condition_variable_any changed_;
  std::shared_ptr<const Value> value_ = std::make_shared<const Value>();
};

}  // namespace octurn
