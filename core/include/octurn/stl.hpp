#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace octurn {

class AtomicFile;

/// One triangle as stored in a binary STL: little-endian, 50 bytes, millimetres, Z up.
#pragma pack(push, 1)
struct Facet {
  std::array<float, 3> normal = {};                  ///< of length one, outward
  std::array<std::array<float, 3>, 3> corners = {};  ///< counter-clockwise seen from outside
  std::uint16_t attributes = 0;                      ///< 0, or `filled_in`
};
#pragma pack(pop)

static_assert(sizeof(Facet) == 50);
static_assert(std::endian::native == std::endian::little,
              "facets are written as they lie in memory");

/// `Facet::attributes` of surface that no snapshot observed and hole filling made. Slicers ignore
/// attributes.
constexpr std::uint16_t filled_in = 1;

/// Receives a surface piece by piece, in order. The span is valid only during the call.
using FacetSink = std::function<void(std::span<const Facet>)>;

/// The size of a binary STL, bytes.
constexpr std::uint64_t stl_bytes(std::uint64_t facets) { return 84 + 50 * facets; }

/// The first 84 bytes of a binary STL.
/// @throws Error "model-too-large"  if the number of facets exceeds 32 bits
std::array<std::byte, 84> stl_header(std::uint64_t facets);

/// A whole binary STL, in memory. @throws Error "model-too-large"
std::string stl_text(std::span<const Facet> facets);

/// A binary STL that appears whole or not at all.
class StlFile {
 public:
  /// @throws Error "write-failed"  if the folder cannot be written to
  explicit StlFile(std::filesystem::path target);
  ~StlFile();
  StlFile(const StlFile&) = delete;
  StlFile& operator=(const StlFile&) = delete;

  /// Appends facets. @throws Error "disk-full", "write-failed"
  void write(std::span<const Facet> facets);

  /// Writes the number of facets into the header, and gives the file its name.
  /// @throws Error "model-too-large", "disk-full", "write-failed"
  void commit();

 private:
  std::unique_ptr<AtomicFile> file_;
  std::uint64_t facets_ = 0;
};

}  // namespace octurn
