#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace octurn {

/// A parallel pipeline: several threads make results from the pieces of one source, and the results
/// are used one by one in the order of the pieces. A thread that is early stores its result and
/// takes the next piece, so that a slow piece blocks no other thread until the window is full.
///
/// TBB's parallel_pipeline does the same, but would add a library of 0.25 MB and a second thread
/// pool to the appliance.
///
/// @tparam Source  called without arguments, by one thread at a time: the next piece as a
///                 std::optional, empty when there are no more
/// @tparam Result  default-constructible; an object is reused for later results
template <typename Source, typename Result>
class OrderedPipeline {
 public:
  /// @param window  pieces in flight at once, stored results included
  OrderedPipeline(Source source, int window)
      : source_(std::move(source)), slots_(static_cast<std::size_t>(window)) {}

  /// Works on pieces until there are no more; called by each thread. When one throws, all return
  /// early, and the exception reaches that one's caller.
  /// @param make  called with a piece and the result to be made of it
  /// @param use  called with a result, by one thread at a time
  template <typename Make, typename Use>
  void run(Make make, Use use) {
    try {
      Result result{};
      while (auto taken = take()) {
        make(taken->piece, result);
        complete(taken->sequence, result, use);
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
    std::size_t sequence;
    typename std::invoke_result_t<Source>::value_type piece;
  };

  struct Slot {
    Result result = {};
    bool is_ready = false;
  };

  Slot& slot(std::size_t sequence) { return slots_[sequence % slots_.size()]; }

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
    return piece ? std::optional(Taken{.sequence = taken_++, .piece = std::move(*piece)})
                 : std::nullopt;
  }

  /// Stores a result, gets a used one in exchange, and uses the results that are next in sequence
  /// unless another thread is doing so.
  template <typename Use>
  void complete(std::size_t sequence, Result& result, Use& use) {
    std::unique_lock lock(mutex_);
    std::swap(slot(sequence).result, result);
    slot(sequence).is_ready = true;
    if (is_using_) {
      return;
    }
    is_using_ = true;
    while (slot(next_).is_ready && !failed_) {
      lock.unlock();
      use(slot(next_).result);
      lock.lock();
      slot(next_++).is_ready = false;
      moved_on_.notify_all();
    }
    is_using_ = false;
  }

  std::mutex taking_ = {};  // guards `source_` and `taken_`
  Source source_;
  std::size_t taken_ = 0;

  std::mutex mutex_ = {};  // guards what follows
  std::condition_variable moved_on_ = {};
  std::vector<Slot> slots_;
  std::size_t next_ = 0;   // sequence number of the result to be used
  bool is_using_ = false;  // a thread uses results
  bool failed_ = false;
};

}  // namespace octurn
