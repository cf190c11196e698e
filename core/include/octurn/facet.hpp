#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <span>

namespace octurn {

/// One triangle as a binary STL holds it: little-endian, 50 bytes, millimetres, Z up, its corners
/// counter-clockwise seen from outside. Surfaces are streamed as spans of these.
#pragma pack(push, 1)
struct Facet {
  std::array<float, 3> normal = {};
  std::array<std::array<float, 3>, 3> corners = {};
  std::uint16_t attributes = 0;
};
#pragma pack(pop)

static_assert(sizeof(Facet) == 50);
static_assert(std::endian::native == std::endian::little,
              "facets are written as they lie in memory");

/// The attributes of a facet where nobody saw the surface, and it was filled in. Slicers pass over
/// it.
constexpr std::uint16_t filled_in = 1;

/// Takes a surface piece by piece, in order. The span is valid during the call only.
using FacetSink = std::function<void(std::span<const Facet>)>;

}  // namespace octurn
