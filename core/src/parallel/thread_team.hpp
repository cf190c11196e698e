#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

namespace octurn {

/// A thread pool for many short steps, one after the other: like `fork_join`, but threads are
/// started once, and joined by the destructor. Not thread-safe, except a team of a single thread.
class ThreadTeam {
 public:
  /// @param threads  at least 1, the caller's among them; the system may give fewer
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  /// The team of the caller alone.
  static ThreadTeam& alone();

  int size() const { return static_cast<int>(others_.size()) + 1; }

  /// Runs `work(i)` for i from 0 to size() - 1, each on a thread of its own (0 on the caller's),
  /// and returns when all have ended. Of several exceptions, that of the lowest i reaches the
  /// caller.
  template <typename Work>
  void run(const Work& work) {
    if (others_.empty()) {
      work(0);
      return;
    }
    begin([](const void* of, int i) { (*static_cast<const Work*>(of))(i); }, &work);
    guarded_call(0);
    finish();
  }

  /// Runs `work(i)` for i below `count`, each on the next free thread.
  template <typename Work>
  void for_each(int count, const Work& work) {
    std::atomic<int> next = 0;
    run([&](int) {
      for (int i = next++; i < count; i = next++) {
        work(i);
      }
    });
  }

  /// The half-open range of items of thread `i`, if `count` items are divided evenly.
  std::pair<std::size_t, std::size_t> share(std::size_t count, int i) const {
    const auto threads = static_cast<std::size_t>(size());
    const auto at = static_cast<std::size_t>(i);
    return {count * at / threads, count * (at + 1) / threads};
  }

 private:
  using Call = void (*)(const void* work, int i);

  void begin(Call call, const void* work);
  void finish();
  void guarded_call(int i);
  void take_part(int i);
  void end();

  Call call_ = nullptr;  // of the step; null: the team ends
  const void* work_ = nullptr;
  std::vector<std::exception_ptr> failures_;
  std::atomic<std::uint32_t> step_ = 0;  // counts the steps
  std::atomic<int> busy_ = 0;            // workers that have not finished the step
  std::vector<std::jthread> others_ = {};
};

}  // namespace octurn
