#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace octurn {

/// Pieces of work from one source that several threads make results of, which are used one by one
/// in the order of their pieces. A thread whose result is early leaves it and goes on with other
/// work.
///
/// @tparam Source  called without arguments, by one thread at a time: the next piece as a
///                 std::optional, empty when there are no more
/// @tparam Result  default-constructible; made anew in one that was used before
template <typename Source, typename Result>
class OrderedPipeline {
 public:
  /// @param window  pieces that may be at hand at once, results that wait for their turn among them
  OrderedPipeline(Source source, int window)
      : source_(std::move(source)), slots_(static_cast<std::size_t>(window)) {}

  /// Takes pieces, on each thread that calls it, until there are no more. Ends early when one has
  /// thrown something, which goes on to that one's caller.
  /// @param make  called with a piece and the result to be made of it
  /// @param use  called with a result, by one thread at a time
  template <typename Make, typename Use>
  void run(Make make, Use use) {
    try {
      Result result{};
      while (auto taken = take()) {
        make(taken->piece, result);
        complete(taken->turn, result, use);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failed_ = true;
      moved_on_.notify_all();
      throw;
    }
  }

 private:
  struct Taken {
    std::size_t turn;
    typename std::invoke_result_t<Source>::value_type piece;
  };

  struct Slot {
    Result result = {};
    bool is_ready = false;
  };

  Slot& slot(std::size_t turn) { return slots_[turn % slots_.size()]; }

  std::optional<Taken> take() {
    const std::lock_guard taking(taking_);
    {
      std::unique_lock lock(mutex_);
      moved_on_.wait(lock, [&] { return taken_ < next_ + slots_.size() || failed_; });
      if (failed_) {
        return std::nullopt;
      }
    }
    auto piece = source_();
    return piece ? std::optional(Taken{.turn = taken_++, .piece = std::move(*piece)})
                 : std::nullopt;
  }

  /// Leaves a result, gets a used one for it, and uses those whose turn it is, if nobody else does.
  template <typename Use>
  void complete(std::size_t turn, Result& result, Use& use) {
    std::unique_lock lock(mutex_);
    std::swap(slot(turn).result, result);
    slot(turn).is_ready = true;
    if (is_used_) {
      return;
    }
    is_used_ = true;
    while (slot(next_).is_ready && !failed_) {
      lock.unlock();
      use(slot(next_).result);
      lock.lock();
      slot(next_++).is_ready = false;
      moved_on_.notify_all();
    }
    is_used_ = false;
  }

  std::mutex taking_ = {};  // guards the source and how often it was asked
  Source source_;
  std::size_t taken_ = 0;

  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable moved_on_ = {};
  std::vector<Slot> slots_;
  std::size_t next_ = 0;  // turn
  bool is_used_ = false;  // by a thread
  bool failed_ = false;
};

}  // namespace octurn
