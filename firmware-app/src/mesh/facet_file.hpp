#pragma once

#include <cstdint>
#include <filesystem>

#include "file_descriptor.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// A binary STL file whose facets can be read in order, in blocks, any number of times.
class FacetFile {
 public:
  /// @throws Error "no-model"  if there is no such file, it has no facets, or its size does not
  /// match
  ///                           their number
  explicit FacetFile(const std::filesystem::path& file);

  std::uint64_t count() const { return count_; }

  /// Passes all facets to the sink, in blocks. @throws Error "read-failed"
  void read(const FacetSink& sink) const;

 private:
  FileDescriptor file_;
  std::uint64_t count_ = 0;
};

}  // namespace octurn
