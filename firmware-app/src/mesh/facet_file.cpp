#include "mesh/facet_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {
namespace {

constexpr std::size_t facets_in_block = 4096;
constexpr std::size_t header_bytes = 84;
constexpr std::size_t count_at = 80;

bool read_at(const FileDescriptor& file, void* bytes, std::size_t size, std::uint64_t offset) {
  return ::pread(file.number(), bytes, size, static_cast<off_t>(offset)) ==
         static_cast<ssize_t>(size);
}

}  // namespace

FacetFile::FacetFile(const std::filesystem::path& file)
    : file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)) {
  std::array<char, header_bytes> header{};
  std::uint32_t count = 0;
  std::error_code error;
  if (file_.is_open() && read_at(file_, header.data(), header.size(), 0)) {
    std::memcpy(&count, header.data() + count_at, sizeof count);
    count_ = count;
  }
  if (count_ == 0 || std::filesystem::file_size(file, error) != stl_bytes(count_)) {
    throw Error(ErrorCode::no_model, "the file of this model is missing, or not whole",
                "Build it again.");
  }
}

void FacetFile::read(const FacetSink& sink) const {
  std::vector<Facet> block(std::min<std::uint64_t>(facets_in_block, count_));
  for (std::uint64_t first = 0; first < count_; first += block.size()) {
    block.resize(std::min<std::uint64_t>(block.size(), count_ - first));
    if (!read_at(file_, block.data(), block.size() * sizeof(Facet), stl_bytes(first))) {
      throw Error(ErrorCode::read_failed, "the file of this model cannot be read to its end",
                  "Build it again.");
    }
    sink(block);
  }
}

}  // namespace octurn
