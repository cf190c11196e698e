#include "laser/line_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace octurn {
namespace {

constexpr std::size_t min_rows = 6;  // of a piece

/// Index of the sample in [first, end) whose column is nearest to `u`; -1 if all are farther than
/// `max_jump`.
std::int32_t nearest_sample(const std::vector<LineSample>& samples, std::size_t first,
                            std::size_t end, float u, float max_jump) {
  std::int32_t best = -1;
  float best_distance = max_jump;
  for (std::size_t i = first; i < end; ++i) {
    const float distance = std::abs(samples[i].u - u);
    if (distance <= best_distance) {
      best = static_cast<std::int32_t>(i);
      best_distance = distance;
    }
  }
  return best;
}

/// Links samples of neighbouring rows that are mutually nearest.
void link(std::vector<LineSample>& samples, float max_jump) {
  std::size_t first = 0;
  while (first < samples.size()) {
    std::size_t end = first;
    while (end < samples.size() && samples[end].row == samples[first].row) {
      ++end;
    }
    std::size_t below = end;
    while (below < samples.size() && samples[below].row == samples[first].row + 1) {
      ++below;
    }
    for (std::size_t i = first; i < end; ++i) {
      const std::int32_t next = nearest_sample(samples, end, below, samples[i].u, max_jump);
      if (next >= 0 &&
          nearest_sample(samples, first, end, samples[static_cast<std::size_t>(next)].u,
                         max_jump) == static_cast<std::int32_t>(i)) {
        samples[i].next = next;
      }
    }
    first = end;
  }
}

/// Returns the column of sample `at`, smoothed by a weighted quadratic fit to the samples around
/// it.
float fitted(std::span<const LineSample> piece, std::size_t at, std::size_t rows) {
  // At an end of the piece the window is shifted inwards, not cut.
  const std::size_t count = std::min(2 * rows + 1, piece.size());
  const std::size_t first = std::min(at > rows ? at - rows : 0, piece.size() - count);
  std::array<double, 5> s{};  // the sums of w x^k
  std::array<double, 3> t{};  // the sums of w x^k y
  for (std::size_t i = first; i < first + count; ++i) {
    const double x = static_cast<double>(i) - static_cast<double>(at);
    const double y = static_cast<double>(piece[i].u) - static_cast<double>(piece[at].u);
    double weight = static_cast<double>(piece[i].light);
    for (std::size_t k = 0; k < s.size(); ++k) {
      s[k] += weight;
      if (k < t.size()) {
        t[k] += weight * y;
      }
      weight *= x;
    }
  }
  // Cramer's rule, written out: a matrix library may fuse products on one processor and not on
  // another.
  const double minor = s[2] * s[4] - s[3] * s[3];
  const double determinant =
      s[0] * minor - s[1] * (s[1] * s[4] - s[2] * s[3]) + s[2] * (s[1] * s[3] - s[2] * s[2]);
  const double change =
      (t[0] * minor - s[1] * (t[1] * s[4] - t[2] * s[3]) + s[2] * (t[1] * s[3] - t[2] * s[2])) /
      determinant;
  return static_cast<float>(static_cast<double>(piece[at].u) + change);
}

/// Marks the samples of a piece that are kept, and smooths their columns.
/// @param chain  indices of its samples, in the order of rows
void smooth_piece(std::vector<LineSample>& samples, const std::vector<std::size_t>& chain,
                  const LineScale& scale, std::vector<char>& kept) {
  const auto edge = static_cast<std::size_t>(scale.edge_rows);
  if (chain.size() < min_rows + 2 * edge) {
    return;
  }
  std::vector<LineSample> piece;
  for (std::size_t i = edge; i + edge < chain.size(); ++i) {
    piece.push_back(samples[chain[i]]);
  }
  for (std::size_t i = 0; i < piece.size(); ++i) {
    samples[chain[i + edge]].u = fitted(piece, i, static_cast<std::size_t>(scale.fit_rows));
    kept[chain[i + edge]] = 1;
  }
}

/// Removes the samples that are not kept, and renumbers the links.
std::vector<LineSample> only_kept(const std::vector<LineSample>& samples,
                                  const std::vector<char>& kept) {
  std::vector<std::int32_t> number(samples.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    number[i] = kept[i] != 0 ? count++ : -1;
  }
  std::vector<LineSample> left;
  left.reserve(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (kept[i] != 0) {
      left.push_back(samples[i]);
      const std::int32_t next = samples[i].next;
      left.back().next = next >= 0 ? number[static_cast<std::size_t>(next)] : -1;
    }
  }
  return left;
}

}  // namespace

std::vector<LineSample> smoothed_pieces(std::vector<LineSample> samples, const LineScale& scale) {
  link(samples, scale.max_jump);
  std::vector<char> kept(samples.size(), 0);
  std::vector<char> followed(samples.size(), 0);
  std::vector<std::size_t> chain;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (followed[i] != 0) {
      continue;
    }
    chain.clear();
    for (auto at = static_cast<std::int32_t>(i); at >= 0;
         at = samples[static_cast<std::size_t>(at)].next) {
      chain.push_back(static_cast<std::size_t>(at));
      followed[static_cast<std::size_t>(at)] = 1;
    }
    smooth_piece(samples, chain, scale, kept);
  }
  return only_kept(samples, kept);
}

}  // namespace octurn
