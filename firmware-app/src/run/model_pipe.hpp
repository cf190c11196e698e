#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "failure.hpp"

namespace octurn {

/// A bounded queue of a model's bytes, from the thread that makes the model to the one that sends
/// it. Either end may stop it; then neither waits for the other.
class ModelPipe {
 public:
  static constexpr std::size_t max_bytes = std::size_t{1} << 20U;

  std::stop_source stop() const { return stop_; }

  // For the producer.

  void set_length(std::uint64_t bytes);
  /// Waits for room. @throws Stopped  if stopped
  void write(std::span<const std::byte> bytes);
  /// Called after the last byte.
  void close();
  /// Ends the model with a failure.
  void fail(Failure reason);

  // For the consumer.

  /// Waits for the length. @throws Error "busy" if stopped before, or the reason of `fail`
  std::uint64_t length();
  /// Waits for bytes. @return empty at the end, or if stopped or failed
  std::vector<std::byte> read();

 private:
  std::stop_source stop_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable_any changed_;
  std::optional<std::uint64_t> length_;
  std::deque<std::vector<std::byte>> blocks_;
  std::size_t held_bytes_ = 0;
  bool closed_ = false;
  std::optional<Failure> failure_;
};

/// A model that is made while it is sent: the consumer of a pipe. Its destructor stops the
/// producer.
class ModelStream {
 public:
  /// Waits until the model's size is known.
  /// @throws Error  if a snapshot is damaged, the model is empty or does not fit into memory
  /// @throws Error "busy"  if a scan starts meanwhile
  explicit ModelStream(std::shared_ptr<ModelPipe> pipe);
  ~ModelStream();
  ModelStream(const ModelStream&) = delete;
  ModelStream& operator=(const ModelStream&) = delete;

  std::uint64_t bytes() const { return bytes_; }

  /// Stop is requested if the model will not be completed, as when a scan starts.
  std::stop_token stop() const { return pipe_->stop().get_token(); }

  /// Passes the bytes of the STL to `sink`; call it once. Ends early if `sink` returns false or the
  /// model is stopped.
  void send(const std::function<bool(std::span<const std::byte>)>& sink);

 private:
  std::shared_ptr<ModelPipe> pipe_;  // shared with the thread that makes the model
  std::uint64_t bytes_ = 0;
};

}  // namespace octurn
