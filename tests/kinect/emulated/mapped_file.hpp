#pragma once

#include <fcntl.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <span>
#include <system_error>

#include "file_descriptor.hpp"

namespace octurn {

/// A file mapped into memory, shared with every process that maps it.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file) : size_(std::filesystem::file_size(file)) {
    const FileDescriptor opened(::open(file.c_str(), O_RDWR | O_CLOEXEC));
    data_ = ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, opened.number(), 0);
    if (data_ == MAP_FAILED) {
      throw std::system_error(errno, std::generic_category(), file.string());
    }
  }
  ~MappedFile() { ::munmap(data_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  void* data() const { return data_; }

  /// The file's content as a value, which must have been constructed in it.
  template <typename Value>
  Value& as() const {
    return *static_cast<Value*>(data_);
  }

  template <typename Value>
  std::span<const Value> values() const {
    return {static_cast<const Value*>(data_), size_ / sizeof(Value)};
  }

 private:
  std::size_t size_;
  void* data_ = nullptr;
};

}  // namespace octurn
