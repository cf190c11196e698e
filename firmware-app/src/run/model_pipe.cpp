#include "run/model_pipe.hpp"

#include <utility>

#include "octurn/error.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

void ModelPipe::set_length(std::uint64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    length_ = bytes;
  }
  changed_.notify_all();
}

void ModelPipe::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    return;  // an empty block marks the end
  }
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop_.get_token(), [&] { return held_bytes_ < max_bytes; });
    if (stop_.stop_requested()) {
      throw Stopped{};
    }
    blocks_.emplace_back(bytes.begin(), bytes.end());
    held_bytes_ += bytes.size();
  }
  changed_.notify_all();
}

void ModelPipe::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

void ModelPipe::fail(Failure reason) {
  {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(reason);
    closed_ = true;
  }
  changed_.notify_all();
}

std::uint64_t ModelPipe::length() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop_.get_token(), [&] { return length_ || closed_; });
  if (failure_) {
    throw to_error(*failure_);
  }
  if (!length_ || stop_.stop_requested()) {
    throw Error(ErrorCode::busy, "a scan has started", "Wait for its end.");
  }
  return *length_;
}

std::vector<std::byte> ModelPipe::read() {
  std::vector<std::byte> block;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, stop_.get_token(), [&] { return !blocks_.empty() || closed_; });
    if (stop_.stop_requested() || blocks_.empty()) {
      return {};
    }
    block = std::move(blocks_.front());
    blocks_.pop_front();
    held_bytes_ -= block.size();
  }
  changed_.notify_all();
  return block;
}

ModelStream::ModelStream(std::shared_ptr<ModelPipe> pipe) : pipe_(std::move(pipe)) {
  try {
    bytes_ = pipe_->length();
  } catch (...) {
    pipe_->stop().request_stop();
    throw;
  }
}

ModelStream::~ModelStream() { pipe_->stop().request_stop(); }

void ModelStream::send(const std::function<bool(std::span<const std::byte>)>& sink) {
  for (std::vector<std::byte> block = pipe_->read(); !block.empty() && sink(block);
       block = pipe_->read()) {
  }
}

}  // namespace octurn
