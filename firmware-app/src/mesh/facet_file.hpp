#pragma once

#include <cstdint>
#include <filesystem>

#include "file_descriptor.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// The facets of a binary STL on the disk, read in order, as often as wanted, a block at a time.
class FacetFile {
 public:
  /// @throws Error "no-model"  if there is no such file, or its size is not that of its facets
  explicit FacetFile(const std::filesystem::path& file);

  std::uint64_t count() const { return count_; }

  /// Hands over all of them. @throws Error "read-failed"  if the disk does not give them
  void read(const FacetSink& sink) const;

 private:
  FileDescriptor file_;
  std::uint64_t count_ = 0;
};

}  // namespace octurn
