#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "lens/board_lattice.hpp"
#include "lens/grey_image.hpp"
#include "lens/homography.hpp"
#include "octurn/lens.hpp"
#include "octurn/median.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr int closing_square = 8;    // square of its radius: dots are 3 pixels apart on the average
constexpr int smoothing_passes = 4;  // each has a variance of half a pixel
constexpr int small_passes = 2;      // of a reduced picture
constexpr float white_share = 0.02F;  // of the pixels, the brightest: 255 after stretching
constexpr std::array<int, 3> reductions{1, 2, 3};
constexpr std::size_t min_seeds = 12;       // corners of a lattice that is worth completing
constexpr double window = 0.8;              // squares from a corner, of the model
constexpr double ramp = 2.2;                // pixels from black to white, halved
constexpr double most_move = 0.35;          // of a square's side, from the predicted place
constexpr double max_step = 0.15;           // squares
constexpr double min_square = 6;            // pixels: smaller ones are blurred away
constexpr double min_contrast_share = 0.7;  // of the median: on the board's edge it is half of it
constexpr int most_completions = 8;         // each adds up to two rows and columns on each side

/// The maxima, or the minima, over discs.
template <typename Better>
GreyImage over_discs(const GreyImage& image, Better better) {
  std::vector<std::pair<int, int>> disc;
  for (int v = -2; v <= 2; ++v) {
    for (int u = -2; u <= 2; ++u) {
      if (u * u + v * v <= closing_square) {
        disc.emplace_back(u, v);
      }
    }
  }
  GreyImage found = image;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      float best = image.at(u, v);
      for (const auto& [right, below] : disc) {
        best = better(best, image.at(std::clamp(u + right, 0, image.width - 1),
                                     std::clamp(v + below, 0, image.height - 1)));
      }
      found.levels[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) +
                   static_cast<std::size_t>(u)] = best;
    }
  }
  return found;
}

/// Closes the gaps between dots, smooths the picture, and stretches its levels to 255.
GreyImage evened(const Picture& picture) {
  GreyImage image = smoothed(reduced(picture, 1));
  image = over_discs(image, [](float a, float b) { return std::max(a, b); });
  image = over_discs(image, [](float a, float b) { return std::min(a, b); });
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    image = smoothed(image);
  }
  std::vector<float> levels = image.levels;
  const auto white = levels.begin() + static_cast<std::ptrdiff_t>(
                                          (1 - white_share) * static_cast<float>(levels.size()));
  std::ranges::nth_element(levels, white);
  const float factor = 255 / std::max(1.0F, *white);
  for (float& level : image.levels) {
    level = std::min(255.0F, factor * level);
  }
  return image;
}

/// The corners that are found at the best of the reductions.
BoardView find_seeds(const GreyImage& image) {
  BoardView most;
  for (const int side : reductions) {
    GreyImage small = reduced(image, side);
    for (int pass = 0; pass < small_passes; ++pass) {
      small = smoothed(small);
    }
    BoardView seeds = find_lattice(small);
    for (BoardCorner& corner : seeds) {
      corner.pixel = to_whole(corner.pixel, side);
    }
    if (seeds.size() > most.size()) {
      most = std::move(seeds);
    }
  }
  return most;
}

Vector2d mapped(const Matrix3d& homography, double column, double row) {
  return (homography * Vector3d(column, row, 1)).hnormalized();
}

/// The homography of most corners: what lies farther off than four times the median is left out.
Matrix3d robust_homography(const BoardView& view) {
  BoardView fitting = view;
  for (int round = 0; round < 3; ++round) {
    const Matrix3d homography = board_homography(fitting);
    std::vector<double> distances;
    for (const BoardCorner& corner : view) {
      distances.push_back((mapped(homography, corner.column, corner.row) - corner.pixel).norm());
    }
    const double limit = std::max(2.0, 4 * median(distances));
    fitting.clear();
    for (std::size_t i = 0; i < view.size(); ++i) {
      if (distances[i] < limit) {
        fitting.push_back(view[i]);
      }
    }
  }
  return board_homography(fitting);
}

/// Four squares about a corner: bright where both coordinates, in squares, have one sign.
struct Saddle {
  Vector2d pixel = Vector2d::Zero();
  double level = 0;     // grey levels, the mean
  double contrast = 0;  // grey levels, half the difference; negative: dark where they have one sign
};

/// Equations of a step of Gauss-Newton for a saddle: level, contrast, and move along both axes.
struct SaddleEquations {
  Matrix4d matrix = Matrix4d::Zero();
  Vector4d right = Vector4d::Zero();
};

/// @param squares_from_pixels  the axes' inverse
/// @param width                pixels, of the model's ramp between squares
SaddleEquations compare(const GreyImage& image, const Saddle& saddle,
                        const Matrix2d& squares_from_pixels, const Vector2d& reach, double width) {
  const Vector2d slopes(1 / (squares_from_pixels.row(0).norm() * width),
                        1 / (squares_from_pixels.row(1).norm() * width));
  SaddleEquations all;
  const auto first = (saddle.pixel - reach).array().ceil().cast<int>().eval();
  const auto last = (saddle.pixel + reach).array().floor().cast<int>().eval();
  for (int v = first.y(); v <= last.y(); ++v) {
    for (int u = first.x(); u <= last.x(); ++u) {
      const Vector2d place = squares_from_pixels * (Vector2d(u, v) - saddle.pixel);
      if (place.cwiseAbs().maxCoeff() > window) {
        continue;
      }
      const Vector2d rise = place.cwiseProduct(slopes);
      const Vector2d sides = rise.cwiseMax(-1).cwiseMin(1);
      const double steepness_x = std::abs(rise.x()) < 1 ? slopes.x() : 0;
      const double steepness_y = std::abs(rise.y()) < 1 ? slopes.y() : 0;
      const Vector4d row(1, sides.prod(), -saddle.contrast * steepness_x * sides.y(),
                         -saddle.contrast * steepness_y * sides.x());
      const double off =
          static_cast<double>(image.at(u, v)) - (saddle.level + saddle.contrast * sides.prod());
      all.matrix += row * row.transpose();
      all.right += row * off;
    }
  }
  return all;
}

/// Fits a saddle.
/// @param axes  pixels for each square: along columns, along rows
/// @return nullopt if it would leave the picture or its place
std::optional<Saddle> fit_saddle(const GreyImage& image, const Matrix2d& axes,
                                 const Vector2d& predicted) {
  constexpr int steps = 10;
  constexpr int wide_steps = 4;  // with a wider ramp, to begin with
  const double square = axes.colwise().norm().minCoeff();
  const Vector2d reach = window * axes.cwiseAbs().rowwise().sum();
  const Matrix2d inverse = axes.inverse();
  Saddle saddle{.pixel = predicted};
  for (int i = 0; i < steps; ++i) {
    const Vector2d far = saddle.pixel + reach;
    if ((saddle.pixel - reach).minCoeff() < 0 || far.x() > image.width - 1 ||
        far.y() > image.height - 1) {
      return std::nullopt;
    }
    SaddleEquations equations =
        compare(image, saddle, inverse, reach, i < wide_steps ? 2 * ramp : ramp);
    equations.matrix(2, 2) += i == 0 ? 1e12 : 1e-6;  // first, the contrast alone
    equations.matrix(3, 3) += i == 0 ? 1e12 : 1e-6;
    const auto solved = solve_symmetric(equations.matrix, equations.right);
    if (!solved) {
      return std::nullopt;
    }
    saddle.level += solved->values[0];
    saddle.contrast += solved->values[1];
    const Vector2d step = solved->values.tail<2>();
    saddle.pixel += axes * step.cwiseMax(-max_step).cwiseMin(max_step);
    if ((saddle.pixel - predicted).norm() > most_move * square) {
      return std::nullopt;
    }
  }
  return saddle;
}

struct LatticeSaddle {
  BoardCorner corner = {};
  double contrast = 0;  // positive where it fits to the squares' alternation, or the reverse
};

/// Fits saddles to all places of a lattice, and two places around it.
std::vector<LatticeSaddle> fit_lattice(const GreyImage& image, const BoardView& view) {
  const Matrix3d homography = robust_homography(view);
  const auto [left, right] = std::ranges::minmax(view, {}, &BoardCorner::column);
  const auto [top, bottom] = std::ranges::minmax(view, {}, &BoardCorner::row);
  std::vector<LatticeSaddle> saddles;
  for (int row = top.row - 2; row <= bottom.row + 2; ++row) {
    for (int column = left.column - 2; column <= right.column + 2; ++column) {
      Matrix2d axes;
      axes << mapped(homography, column + 0.5, row) - mapped(homography, column - 0.5, row),
          mapped(homography, column, row + 0.5) - mapped(homography, column, row - 0.5);
      const double size = axes.colwise().norm().minCoeff();
      if (!(size >= min_square) || size > image.width || std::abs(axes.determinant()) < size) {
        continue;
      }
      if (const auto found = fit_saddle(image, axes, mapped(homography, column, row))) {
        saddles.push_back(
            {.corner = {.pixel = found->pixel, .column = column, .row = row},
             .contrast = (column + row) % 2 == 0 ? found->contrast : -found->contrast});
      }
    }
  }
  return saddles;
}

/// The corners whose contrast is as the most of them have it.
BoardView alternating(const std::vector<LatticeSaddle>& saddles, const BoardView& seeds) {
  std::vector<double> contrasts;
  for (const LatticeSaddle& saddle : saddles) {
    const bool is_seed = std::ranges::any_of(seeds, [&](const BoardCorner& seed) {
      return seed.column == saddle.corner.column && seed.row == saddle.corner.row;
    });
    if (is_seed) {
      contrasts.push_back(saddle.contrast);
    }
  }
  if (contrasts.empty()) {
    return {};
  }
  const double usual = median(std::move(contrasts));
  BoardView view;
  for (const LatticeSaddle& saddle : saddles) {
    if (saddle.contrast / usual > min_contrast_share) {
      view.push_back(saddle.corner);
    }
  }
  return view;
}

}  // namespace

BoardView find_dotted_board(const Picture& picture) {
  const GreyImage image = evened(picture);
  BoardView view = find_seeds(image);
  for (int i = 0; i < most_completions; ++i) {
    if (view.size() < min_seeds) {
      return {};
    }
    BoardView whole = alternating(fit_lattice(image, view), view);
    const bool is_complete = i > 0 && whole.size() <= view.size();
    view = std::move(whole);
    if (is_complete) {
      break;
    }
  }
  return view.size() < min_board_corners ? BoardView{} : view;
}

}  // namespace octurn
