#include "tsdf/facet_stream.hpp"

#include "octurn/snapshot.hpp"

namespace octurn {

void KeptFacets::add(std::span<const Facet> facets) {
  bytes_ += facets.size_bytes();
  is_whole_ = is_whole_ && bytes_ <= max_bytes_;
  if (is_whole_) {
    pieces_.emplace_back(facets.begin(), facets.end());
  } else {
    pieces_ = {};
  }
}

void KeptFacets::stream(const FacetSink& sink, const std::stop_token& stop) const {
  for (const std::vector<Facet>& piece : pieces_) {
    throw_if_stopped(stop);
    sink(piece);
  }
}

}  // namespace octurn
