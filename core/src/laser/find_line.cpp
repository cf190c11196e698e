#include "laser/find_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "octurn/light_channel.hpp"

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

/// Links the samples of neighbouring rows to pieces of line, drops short pieces and the ends of the
/// others, and smooths each sample's column by a quadratic fit along its piece.
///
/// @param samples  sorted by row, then column; not linked yet
/// @return the remaining samples, in the same order
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

// Rows are smoothed by the binomial filter 1 4 6 4 1, whose gain is 16.
constexpr int gain = 16;
constexpr int filter_reach = 2;  // pixels of the filter to each side

// Thresholds on the smoothed difference: grey levels above the dark picture, times the gain.
constexpr int min_peak = 8 * gain;
constexpr int noise = 2 * gain;       // below it there is no light
constexpr int min_valley = 5 * gain;  // that separates two lines; bright ones need more
constexpr int valley_share = 5;       // of a peak, the same: a fifth
constexpr int light_share = 20;       // of a peak: a line's light ends at a twentieth

// A real line has a halo, from the material and the lens: up to half of the peak, tens of pixels
// wide. The line itself reaches beyond its full width at half maximum (FWHM) by a pixel plus this
// multiple of the FWHM, on each side. Light beyond that is halo, and a straight baseline removes
// it.
constexpr double skirt = 0.6;

// A halo is a crest, higher in its middle than the baseline, and higher on one side of the line
// than on the other. So the lowest light above the baseline is left out, too, of the peak's height:
// this multiple of the halo's share, the best for the measured halos of plastic, plaster, paper and
// sponge together.
constexpr double halo_crest = 1.4;
// A wide line with a halo is light that scatters below the surface, farther to one side than to the
// other: only the middle of such a line is where the laser meets the surface. From `narrow` to
// `broad` pixels at half maximum the share that is left out grows from none to `max_level`.
constexpr double narrow = 5;
constexpr double broad = 10;
constexpr double max_level = 0.5;

constexpr int max_half_width = 40;  // pixels: no line is wider
constexpr float min_light = 25;     // grey levels, summed over the line's width

// Glare: a line with at least this many saturated pixels, which are more than half of its width.
constexpr int saturated = 250;  // grey levels
constexpr int min_saturated_pixels = 6;
constexpr int max_saturated_share = 2;  // half of the line's pixels

// Largest standard deviation across a line: `wide` times the picture's median, plus `wide_pixels`.
constexpr double wide = 2.5;
constexpr double wide_pixels = 0.5;

/// A candidate, and the shape of its light.
struct Candidate {
  LineSample sample;
  int peak = 0;         // smoothed grey levels, times the gain
  float deviation = 0;  // pixels, standard deviation
};

/// One row of two pictures.
struct Row {
  std::span<const std::uint8_t> dark;
  std::span<const std::uint8_t> lit;
  std::vector<int> smooth = {};  // the smoothed difference, times the gain

  int difference(int u) const {
    const auto i = static_cast<std::size_t>(u);
    return static_cast<int>(lit[i]) - static_cast<int>(dark[i]);
  }
  int at(int u) const { return smooth[static_cast<std::size_t>(u)]; }
  int width() const { return static_cast<int>(lit.size()); }
};

/// @return false if no pixel is bright enough for a line
bool smooth(Row& row, std::vector<int>& difference) {
  const auto width = row.lit.size();
  int brightest = 0;
  for (std::size_t u = 0; u < width; ++u) {
    difference[u] = static_cast<int>(row.lit[u]) - static_cast<int>(row.dark[u]);
    brightest = std::max(brightest, difference[u]);
  }
  if (brightest * gain < min_peak) {
    return false;
  }
  for (std::size_t u = filter_reach; u + filter_reach < width; ++u) {
    row.smooth[u] = difference[u - 2] + difference[u + 2] +
                    4 * (difference[u - 1] + difference[u + 1]) + 6 * difference[u];
  }
  return true;
}

/// The last pixel of a peak's light in one direction, or -1 if a higher peak follows without a
/// valley between.
int end_of_light(const Row& row, int peak, int step) {
  const int top = row.at(peak);
  const int floor = std::max(noise, top / light_share);
  const int valley = std::max(min_valley, top / valley_share);
  int lowest = top;
  int lowest_at = peak;
  for (int u = peak;
       u >= filter_reach && u < row.width() - filter_reach && std::abs(u - peak) <= max_half_width;
       u += step) {
    const int value = row.at(u);
    if (value < floor) {
      return u - step;
    }
    if (value > lowest + valley) {
      return lowest_at;
    }
    if (value > top || (value == top && step < 0 && lowest < top)) {
      return -1;
    }
    if (value < lowest) {
      lowest = value;
      lowest_at = u;
    }
  }
  return lowest_at;
}

/// The pixels of a line.
struct Extent {
  int first = 0;
  int last = 0;
};

/// A straight baseline from a line's first pixel to its last, in smoothed grey levels times `gain`.
struct Baseline {
  int first = 0;
  int last = 0;
  double level = 0;  ///< above the baseline, from which light counts; a share of the peak's height
};

/// Takes the halo off a peak's light: narrows it to the line, and returns the halo's baseline.
Baseline take_off_halo(const Row& row, int peak, Extent& light) {
  const int half = row.at(peak) / 2;
  Extent bright{.first = peak, .last = peak};
  while (bright.first > light.first && row.at(bright.first - 1) >= half) {
    --bright.first;
  }
  while (bright.last < light.last && row.at(bright.last + 1) >= half) {
    ++bright.last;
  }
  const int more = 1 + static_cast<int>(std::lround(skirt * (bright.last - bright.first + 1)));
  Baseline halo;
  if (bright.first - more > light.first) {
    light.first = bright.first - more;
    halo.first = row.at(light.first);
  }
  if (bright.last + more < light.last) {
    light.last = bright.last + more;
    halo.last = row.at(light.last);
  }
  if (halo.first > 0 || halo.last > 0) {
    const double share = 0.5 * (halo.first + halo.last) / row.at(peak);
    const double width = bright.last - bright.first + 1;
    const double scattered = max_level * (width - narrow) / (broad - narrow);
    halo.level = std::clamp(std::max(halo_crest * share, scattered), 0.0, max_level);
  }
  return halo;
}

/// The centre of mass of the peak's light without its halo.
Candidate make_candidate(const Row& row, int peak, Extent line) {
  const Baseline halo = take_off_halo(row, peak, line);
  const double base = static_cast<double>(halo.first) / gain;
  const double slope = (static_cast<double>(halo.last) / gain - base) / (line.last - line.first);
  const double top = static_cast<double>(row.at(peak)) / gain;
  const double level = halo.level * (top - (base + slope * (peak - line.first)));
  double light = 0;
  double moment = 0;
  double second = 0;
  for (int u = line.first; u <= line.last; ++u) {
    const double at = u - line.first;
    const double value = std::max(row.difference(u) - (base + slope * at) - level, 0.0);
    light += value;
    moment += value * at;
    second += value * at * at;
  }
  if (light <= 0) {
    return {};
  }
  const double mean = moment / light;
  return {
      .sample = {.u = static_cast<float>(line.first + mean), .light = static_cast<float>(light)},
      .peak = row.at(peak),
      .deviation = static_cast<float>(std::sqrt(std::max(second / light - mean * mean, 0.0)))};
}

/// Whether most of a line's pixels are saturated, as in glare.
bool is_glare(const Row& row, int first, int last) {
  int count = 0;
  for (int u = first; u <= last; ++u) {
    count += row.lit[static_cast<std::size_t>(u)] >= saturated ? 1 : 0;
  }
  return count >= min_saturated_pixels && count * max_saturated_share > last - first + 1;
}

void find_candidates(const Row& row, int v, std::vector<Candidate>& candidates) {
  for (int u = filter_reach; u < row.width() - filter_reach; ++u) {
    if (row.at(u) < min_peak || row.at(u) < row.at(u - 1) || row.at(u) <= row.at(u + 1)) {
      continue;
    }
    const int first = end_of_light(row, u, -1);
    const int last = end_of_light(row, u, 1);
    if (first < 0 || last < 0 || first == last || is_glare(row, first, last)) {
      continue;
    }
    Candidate found = make_candidate(row, u, {.first = first, .last = last});
    if (found.sample.light >= min_light) {
      found.sample.row = v;
      candidates.push_back(found);
    }
  }
}

/// The median of the candidates' deviations, weighted by their peaks: a picture has more candidates
/// of glow and reflections than of the line, but they are dimmer.
/// @param candidates  at least one
float median_deviation(const std::vector<Candidate>& candidates) {
  std::vector<std::pair<float, int>> weighted;
  std::int64_t total = 0;
  for (const Candidate& candidate : candidates) {
    weighted.emplace_back(candidate.deviation, candidate.peak);
    total += candidate.peak;
  }
  std::ranges::sort(weighted);
  std::int64_t below = 0;
  return std::ranges::find_if(weighted,
                              [&](const auto& entry) {
                                below += entry.second;
                                return 2 * below >= total;
                              })
      ->first;
}

/// Drops candidates that are far wider than the picture's line: subsurface scattering, or light
/// from two surfaces.
std::vector<LineSample> without_wide(const std::vector<Candidate>& candidates) {
  std::vector<LineSample> samples;
  if (candidates.empty()) {
    return samples;
  }
  const double limit = wide * static_cast<double>(median_deviation(candidates)) + wide_pixels;
  for (const Candidate& candidate : candidates) {
    if (static_cast<double>(candidate.deviation) <= limit) {
      samples.push_back(candidate.sample);
    }
  }
  return samples;
}

constexpr int brighter = 2;           // than luminance, from which another channel is taken
constexpr int rows_per_lit_row = 30;  // at most, of a picture that shows a line
constexpr std::size_t row_step = 4;   // of the rows that are compared

std::uint8_t level_in(Channel channel, const Rgb& colour) {
  return channel == Channel::luminance ? luminance(colour)
                                       : colour[static_cast<std::size_t>(channel) - 1];
}

/// The light of a line in a channel, grey levels, summed over every fourth row. Noise takes as much
/// as it adds, and cancels.
std::int64_t line_light(const ColourPicture& dark, const ColourPicture& lit, Channel channel) {
  std::int64_t light = 0;
  const auto width = static_cast<std::size_t>(lit.width);
  for (std::size_t first = 0; first < lit.pixels.size(); first += row_step * width) {
    int darkest = 0;
    int brightest = 0;
    for (std::size_t i = first; i < first + width; ++i) {
      const int change = static_cast<int>(level_in(channel, lit.pixels[i])) -
                         static_cast<int>(level_in(channel, dark.pixels[i]));
      darkest = std::min(darkest, change);
      brightest = std::max(brightest, change);
    }
    light += brightest + darkest;
  }
  return light;
}

}  // namespace

Picture to_picture(const ColourPicture& picture, Channel channel) {
  Picture grey{.width = picture.width, .height = picture.height, .samples = {}};
  grey.samples.reserve(picture.pixels.size());
  for (const Rgb& pixel : picture.pixels) {
    grey.samples.push_back(level_in(channel, pixel));
  }
  return grey;
}

Channel find_channel(const ColourPicture& dark, const ColourPicture& lit) {
  const std::int64_t least = static_cast<std::int64_t>(lit.height) * (min_peak / gain) /
                             static_cast<int>(row_step) / rows_per_lit_row;
  std::int64_t most = std::max(brighter * line_light(dark, lit, Channel::luminance), least);
  Channel best = Channel::luminance;
  for (const Channel channel : {Channel::red, Channel::green, Channel::blue}) {
    if (const std::int64_t light = line_light(dark, lit, channel); light > most) {
      most = light;
      best = channel;
    }
  }
  return best;
}

LineScale line_scale(double pixel) {
  constexpr double fit_reach = 0.0011;  // metres: finer detail is noise
  constexpr double edge = 0.0004;       // half a line's width
  constexpr double jump = 0.0012;
  const auto rows = [&](double length, int max) {
    return static_cast<int>(std::lround(std::clamp(length / pixel, 1.0, static_cast<double>(max))));
  };
  return {.fit_rows = rows(fit_reach, 12),
          .edge_rows = rows(edge, 4),
          .max_jump = static_cast<float>(std::clamp(jump / pixel, 2.0, 12.0))};
}

std::vector<LineSample> find_line(const Picture& dark, const Picture& lit, const LineScale& scale) {
  const auto width = static_cast<std::size_t>(lit.width);
  std::vector<int> difference(width);
  Row row;
  row.smooth.resize(width);
  std::vector<Candidate> candidates;
  for (int v = 0; v < lit.height; ++v) {
    const std::size_t begin = static_cast<std::size_t>(v) * width;
    row.dark = std::span(dark.samples).subspan(begin, width);
    row.lit = std::span(lit.samples).subspan(begin, width);
    if (smooth(row, difference)) {
      find_candidates(row, v, candidates);
    }
  }
  return smoothed_pieces(without_wide(candidates), scale);
}

}  // namespace octurn
