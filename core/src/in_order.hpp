#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

namespace octurn {

/// Lets threads take pieces of work from one source, and hand in what comes of them in the order in
/// which they were taken.
///
/// @tparam Source  called without arguments, by one thread at a time: the next piece as a
///                 std::optional, empty when there are no more
template <typename Source>
class InOrder {
 public:
  explicit InOrder(Source source) : source_(std::move(source)) {}

  /// Calls `work` for piece after piece until there are no more, or a thread has failed. What `work`
  /// throws ends all.
  /// @param work  called with a piece and `in_turn`, which calls what it is given when all pieces
  ///              before this one were handed in; not, if one of them has failed
  template <typename Work>
  void take_all(Work work) {
    try {
      while (auto taken = take()) {
        work(std::move(taken->piece),
             [&](auto hand_in) { this->in_turn(taken->turn, std::move(hand_in)); });
      }
    } catch (...) {
      fail();
      throw;
    }
  }

 private:
  struct Taken {
    std::size_t turn;
    typename std::invoke_result_t<Source>::value_type piece;
  };

  std::optional<Taken> take() {
    const std::lock_guard taking(taking_);
    if (has_failed()) {
      return std::nullopt;
    }
    auto piece = source_();
    return piece ? std::optional(Taken{.turn = taken_++, .piece = std::move(*piece)})
                 : std::nullopt;
  }

  template <typename HandIn>
  void in_turn(std::size_t turn, HandIn hand_in) {
    std::unique_lock lock(mutex_);
    moved_on_.wait(lock, [&] { return next_ == turn || failed_; });
    if (failed_) {
      return;
    }
    lock.unlock();  // only the thread whose turn it is gets here
    hand_in();
    lock.lock();
    ++next_;
    moved_on_.notify_all();
  }

  bool has_failed() {
    const std::lock_guard lock(mutex_);
    return failed_;
  }

  /// Lets nobody wait for a piece that will not come.
  void fail() {
    const std::lock_guard lock(mutex_);
    failed_ = true;
    moved_on_.notify_all();
  }

  std::mutex taking_ = {};  // guards the source and how often it was asked
  Source source_;
  std::size_t taken_ = 0;
  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable moved_on_ = {};
  std::size_t next_ = 0;
  bool failed_ = false;
};

}  // namespace octurn
