#include "parallel/thread_team.hpp"

#include <algorithm>
#include <system_error>

namespace octurn {
namespace {

// Polls, with a yield in between, before a thread sleeps. Steps follow each other within
// microseconds, so that it mostly need not be woken.
constexpr int looks = 100;

/// Waits while an atomic has a value.
template <typename Value>
void wait_while(const std::atomic<Value>& atomic, Value value) {
  for (int i = 0; i < looks; ++i) {
    if (atomic.load(std::memory_order_acquire) != value) {
      return;
    }
    std::this_thread::yield();
  }
  atomic.wait(value, std::memory_order_acquire);
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) : failures_(static_cast<std::size_t>(threads)) {
  others_.reserve(failures_.size());
  try {
    for (int i = 1; i < threads; ++i) {
      others_.emplace_back([this, i] { take_part(i); });
    }
  } catch (const std::system_error&) {
    // the system's limit of threads, such as that of a service: the team is smaller
  }
}

ThreadTeam::~ThreadTeam() { end(); }

ThreadTeam& ThreadTeam::alone() {
  static ThreadTeam team(1);
  return team;
}

void ThreadTeam::begin(Call call, const void* work) {
  call_ = call;
  work_ = work;
  busy_.store(static_cast<int>(others_.size()), std::memory_order_relaxed);
  step_.fetch_add(1, std::memory_order_release);
  step_.notify_all();
}

void ThreadTeam::finish() {
  for (int left = busy_.load(std::memory_order_acquire); left != 0;
       left = busy_.load(std::memory_order_acquire)) {
    wait_while(busy_, left);
  }
  std::exception_ptr first;
  for (std::exception_ptr& failure : failures_) {
    const std::exception_ptr taken = std::exchange(failure, nullptr);
    first = first ? first : taken;
  }
  if (first) {
    std::rethrow_exception(first);
  }
}

void ThreadTeam::guarded_call(int i) {
  try {
    call_(work_, i);
  } catch (...) {
    failures_[static_cast<std::size_t>(i)] = std::current_exception();
  }
}

/// The loop of a worker thread, until the team ends.
void ThreadTeam::take_part(int i) {
  for (std::uint32_t step = 0;; ++step) {
    wait_while(step_, step);
    if (call_ == nullptr) {
      return;
    }
    guarded_call(i);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
      busy_.notify_one();
    }
  }
}

void ThreadTeam::end() {
  begin(nullptr, nullptr);
  others_.clear();  // joins them
}

}  // namespace octurn
