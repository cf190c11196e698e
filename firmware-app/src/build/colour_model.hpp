#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "octurn/model.hpp"
#include "store/stored_scan.hpp"

namespace octurn {

/// What the colours of a model's vertices show.
enum class Colours {
  pictures,  ///< the object's own, from the pictures of a scan by laser line
  views,     ///< how many snapshots of a depth sensor saw the place, as `colours_of_views`
};

/// The colours of a model's vertices, in the folder of its STL: three bytes for each, in the order
/// of a `VertexTable`.
std::filesystem::path colours_file(const std::filesystem::path& model, Colours shown);

/// Computes the colours from the model's scan, and writes that file atomically.
/// @param memory_limit  bytes, of this process; 0: none
/// @throws Error "bad-settings"  if the scan is of the other kind
/// @throws Error "memory-limit"  if the model has so many triangles that the limit may be exceeded;
///                               as `vertex_colours` or `view_colours`; "disk-full",
///                               "write-failed"; Stopped
void colour_model(const std::filesystem::path& model, const ModelScan& of, Colours shown,
                  std::size_t memory_limit, const std::stop_token& stop);

/// Reads that file.
/// @throws Error "read-failed"  if it is missing or incomplete
std::vector<Rgb> read_colours(const std::filesystem::path& model, Colours shown);

}  // namespace octurn
