#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

#include "octurn/scan_folder.hpp"

namespace octurn {

/// Red, green and blue, as a camera's picture has them (sRGB).
using Rgb = std::array<std::uint8_t, 3>;

/// A camera's picture in colour.
struct ColourPicture {
  int width = 0;                 ///< pixels
  int height = 0;                ///< pixels
  std::vector<Rgb> pixels = {};  ///< width x height, row by row from the top left
};

/// Encodes a picture as 8-bit RGB PNG, fast rather than small.
/// @throws std::invalid_argument  if it is empty, or there are not width x height pixels
std::vector<std::byte> encode_rgb_png(const ColourPicture& picture);

/// Decodes an 8-bit PNG of exactly that size in pixels: RGB, or greyscale, whose colours are grey.
///
/// @param name  of the file, for messages
/// @throws Error "snapshot-malformed"  if it is something else, has another size, is damaged, cut
///                                     short, or followed by other bytes
ColourPicture decode_rgb_png(std::string_view name, std::span<const std::byte> png, int width,
                             int height);

/// A model's vertices, and the three of each triangle, counter-clockwise seen from outside.
struct VertexMesh {
  std::span<const std::array<float, 3>> vertices = {};  ///< millimetres, object's frame
  std::span<const std::array<std::uint32_t, 3>> triangles = {};
};

/// The colours of a model's vertices, from the pictures without a laser of the scan that it was
/// made of: the mean of those that see a vertex, weighted by the squared cosine between its normal
/// and the way to the camera. At most 36 pictures of each pose are read; those that are damaged are
/// left out. A vertex that none sees has the mean of its neighbours' colours.
///
/// Pictures are exposed for lasers, and dark: all colours are brightened by one factor, so that one
/// in a hundred vertices has a level of 240 or more. The factor is never below 1.
///
/// @param scan  by laser line, with the poses that the model was made with
/// @return as many as there are vertices; white where nothing of a connected part was seen
/// @throws Error "scan-malformed"  if it is no scan by laser line, or how its object lay is not
///                                 known
/// @throws Stopped  once `stop` is requested
std::vector<Rgb> vertex_colours(const std::filesystem::path& folder, const Scan& scan,
                                const VertexMesh& mesh, const std::stop_token& stop = {});

}  // namespace octurn
