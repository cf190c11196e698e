#include "lens/lens_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "octurn/median.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr int max_steps = 100;
constexpr double small_gain = 1e-10;  // of the sum of squares
constexpr double first_damping = 1e-3;
constexpr double most_damping = 1e8;

/// The weight of fx - fy, which is 0 to a thousandth of a pixel where pixels are square.
double weight_of(PixelShape shape) { return shape == PixelShape::square ? 1e6 : 0; }

/// The normal equations of one view.
struct ViewEquations {
  Matrix6d lens = Matrix6d::Zero();
  Matrix6d both = Matrix6d::Zero();  // lens by board
  Matrix6d board = Matrix6d::Zero();
  Vector6d lens_right = Vector6d::Zero();
  Vector6d board_right = Vector6d::Zero();
};

struct Equations {
  std::vector<ViewEquations> views = {};
  Matrix6d shape = Matrix6d::Zero();  // of the pixels
  Vector6d shape_right = Vector6d::Zero();
  double squares = 0;  // of the residuals, pixels
};

double sum_of_squares(const std::vector<BoardView>& views, const LensAndBoards& at,
                      PixelShape shape) {
  double squares = weight_of(shape) * std::pow(at.lens[0] - at.lens[1], 2);
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const BoardCorner& corner : views[i]) {
      squares += (see(at.lens, at.camera_from_board[i], corner).pixel - corner.pixel).squaredNorm();
    }
  }
  return squares;
}

Equations equations_at(const std::vector<BoardView>& views, const LensAndBoards& at,
                       PixelShape shape) {
  Vector6d unequal = Vector6d::Zero();
  unequal.head<2>() = Vector2d(1, -1);
  const double weight = weight_of(shape);
  const double off_square = at.lens[0] - at.lens[1];
  Equations all{.shape = weight * unequal * unequal.transpose(),
                .shape_right = -weight * off_square * unequal,
                .squares = weight * off_square * off_square};
  for (std::size_t i = 0; i < views.size(); ++i) {
    ViewEquations view;
    for (const BoardCorner& corner : views[i]) {
      const SeenCorner seen = see(at.lens, at.camera_from_board[i], corner);
      const Vector2d off = corner.pixel - seen.pixel;
      view.lens += seen.by_lens.transpose() * seen.by_lens;
      view.both += seen.by_lens.transpose() * seen.by_board;
      view.board += seen.by_board.transpose() * seen.by_board;
      view.lens_right += seen.by_lens.transpose() * off;
      view.board_right += seen.by_board.transpose() * off;
      all.squares += off.squaredNorm();
    }
    all.views.push_back(view);
  }
  return all;
}

Matrix6d damped(Matrix6d matrix, double damping) {
  matrix.diagonal() *= 1 + damping;
  return matrix;
}

/// The lens's equations after elimination of the boards (Schur complement).
std::pair<Matrix6d, Vector6d> without_boards(const Equations& equations, double damping) {
  Matrix6d matrix = equations.shape;
  Vector6d right = equations.shape_right;
  for (const ViewEquations& view : equations.views) {
    const Eigen::LDLT<Matrix6d> board(damped(view.board, damping));
    matrix += damped(view.lens, damping) - view.both * board.solve(view.both.transpose());
    right += view.lens_right - view.both * board.solve(view.board_right);
  }
  return {matrix, right};
}

LensAndBoards stepped(const LensAndBoards& from, const Equations& equations, double damping) {
  const auto [matrix, right] = without_boards(equations, damping);
  const Vector6d change = matrix.ldlt().solve(right);
  LensAndBoards to = from;
  to.lens += change;
  for (std::size_t i = 0; i < equations.views.size(); ++i) {
    const ViewEquations& view = equations.views[i];
    const Vector6d move =
        damped(view.board, damping).ldlt().solve(view.board_right - view.both.transpose() * change);
    const Eigen::Vector3d turn = move.head<3>();
    Eigen::Isometry3d& pose = to.camera_from_board[i];
    if (const double angle = turn.norm(); angle > 0) {
      pose.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * pose.linear();
    }
    pose.translation() += move.tail<3>();
  }
  return to;
}

/// Whether all numbers are finite, focal lengths are positive, and boards are in front of the
/// camera.
bool is_sound(const LensAndBoards& at) {
  return at.lens.allFinite() && at.lens[0] > 0 && at.lens[1] > 0 &&
         std::ranges::all_of(at.camera_from_board, [](const Eigen::Isometry3d& pose) {
           return pose.matrix().allFinite() && pose.translation().z() > 0;
         });
}

std::size_t count_corners(const std::vector<BoardView>& views) {
  std::size_t count = 0;
  for (const BoardView& view : views) {
    count += view.size();
  }
  return count;
}

}  // namespace

LensFit fit_lens(const std::vector<BoardView>& views, LensAndBoards first, PixelShape shape) {
  LensFit fit{.found = std::move(first)};
  Equations equations = equations_at(views, fit.found, shape);
  double damping = first_damping;
  for (int step = 0; step < max_steps && damping < most_damping; ++step) {
    LensAndBoards next = stepped(fit.found, equations, damping);
    const double squares = is_sound(next) ? sum_of_squares(views, next, shape) : equations.squares;
    if (!(squares < equations.squares)) {
      damping *= 10;
      continue;
    }
    const bool is_done = equations.squares - squares < small_gain * equations.squares;
    fit.found = std::move(next);
    equations = equations_at(views, fit.found, shape);
    damping /= 10;
    if (is_done) {
      break;
    }
  }
  const auto corners = static_cast<double>(count_corners(views));
  const double unknowns = 6 + 6 * static_cast<double>(views.size());
  const double variance = equations.squares / std::max(1.0, 2 * corners - unknowns);
  const Matrix6d spread = without_boards(equations, 0).first.fullPivLu().inverse();
  fit.sigma = (variance * spread.diagonal()).cwiseAbs().cwiseSqrt();
  fit.rms = std::sqrt(equations.squares / corners);
  return fit;
}

void drop_outliers(std::vector<BoardView>& views, const LensAndBoards& found) {
  const auto off = [&](std::size_t view, const BoardCorner& corner) {
    return (see(found.lens, found.camera_from_board[view], corner).pixel - corner.pixel).norm();
  };
  std::vector<double> distances;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const BoardCorner& corner : views[i]) {
      distances.push_back(off(i, corner));
    }
  }
  const double farthest = std::max(0.5, 5 * median(std::move(distances)));
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::erase_if(views[i], [&](const BoardCorner& corner) { return off(i, corner) > farthest; });
  }
}

}  // namespace octurn
