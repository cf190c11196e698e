#include "mesh/vertex_table.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

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

namespace {

constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t first_slots = 1024;             // a power of two, and doubled to grow
constexpr std::size_t max_vertices = 2'300'000;       // 28 MB, and 17 MB of slots
constexpr std::uint64_t mixer = 0x9e3779b97f4a7c15U;  // 2^64 / golden ratio, as Fibonacci hashing

std::uint64_t hash(const Vertex& vertex) {
  std::uint64_t mixed = 0;
  for (const float coordinate : vertex) {
    mixed = (std::rotl(mixed, 23) ^ std::bit_cast<std::uint32_t>(coordinate)) * mixer;
  }
  return mixed ^ (mixed >> 32U);
}

bool is_same(const Vertex& a, const Vertex& b) {
  return std::bit_cast<std::array<std::uint32_t, 3>>(a) ==
         std::bit_cast<std::array<std::uint32_t, 3>>(b);
}

}  // namespace

VertexTable::VertexTable(const FacetFile& facets) : slots_(first_slots, empty) {
  vertices_.reserve(
      std::min<std::uint64_t>(max_vertices + 3 * facets_in_block, 3 * facets.count()));
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      for (const Vertex& corner : corners) {
        insert(corner);
      }
    }
    if (vertices_.size() > max_vertices) {
      throw Error(ErrorCode::memory_limit,
                  "the model has " + std::to_string(facets.count()) +
                      " triangles, too many for a format that lists its corners",
                  "Download the STL, or build it with a larger leaf size.",
                  {{"triangles", static_cast<double>(facets.count())}});
    }
  });
}

/// The slot of a vertex, or the free slot where it belongs.
std::size_t VertexTable::find_slot(const Vertex& vertex) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash(vertex) & mask;
  while (slots_[slot] != empty && !is_same(vertices_[slots_[slot]], vertex)) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

void VertexTable::insert(const Vertex& vertex) {
  const std::size_t slot = find_slot(vertex);
  if (slots_[slot] == empty) {
    slots_[slot] = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(vertex);
    if (vertices_.size() * 3 > slots_.size() * 2) {
      grow();
    }
  }
}

void VertexTable::grow() {
  slots_.assign(slots_.size() * 2, empty);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    slots_[find_slot(vertices_[i])] = static_cast<std::uint32_t>(i);
  }
}

std::uint32_t VertexTable::index(const Vertex& vertex) const { return slots_[find_slot(vertex)]; }

}  // namespace octurn
