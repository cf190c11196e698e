#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "octurn/atomic_file.hpp"
#include "octurn/facet.hpp"

namespace octurn {

/// The bytes of a binary STL of that many facets.
constexpr std::uint64_t stl_bytes(std::uint64_t facets) { return 84 + 50 * facets; }

/// The first 84 bytes of a binary STL.
/// @throws Error "model-too-large"  if there are more facets than the format can count
std::array<std::byte, 84> stl_header(std::uint64_t facets);

/// A binary STL, whole in memory.
std::string stl_text(std::span<const Facet> facets);

/// A binary STL that appears whole or not at all.
class StlFile {
 public:
  /// @throws Error  if the folder cannot be written to
  explicit StlFile(std::filesystem::path target);

  /// @throws Error  if the disk is full or does not take it
  void write(std::span<const Facet> facets);

  /// Writes the number of facets into the header, and puts the file in its place.
  void commit();

 private:
  AtomicFile file_;
  std::uint64_t facets_ = 0;
};

}  // namespace octurn
