#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/stl.hpp"

namespace octurn {

/// The facets of a surface that was counted, kept until the surface is drawn: all of them, or none
/// if they do not fit.
class KeptFacets {
 public:
  explicit KeptFacets(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Adds a piece; drops everything if it does not fit.
  void add(std::span<const Facet> facets);

  bool is_whole() const { return is_whole_; }

  /// Passes on the pieces that were added. @throws Stopped  between two of them
  void stream(const FacetSink& sink, const std::stop_token& stop) const;

 private:
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  bool is_whole_ = true;
  std::vector<std::vector<Facet>> pieces_ = {};
};

}  // namespace octurn
