#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/lens.hpp"

namespace octurn {

/// What the person who holds a board should do next.
enum class BoardAdvice {
  show,        ///< no board is seen
  hold_still,  ///< it moves
  tilt,        ///< this place was taken already; boards were never tilted far enough
  reach,       ///< this place was taken already; a part of the picture has never shown a board
  turn,        ///< this place was taken already: any other place will do
};

/// Feedback for the person who holds a board.
struct BoardLook {
  BoardAdvice advice = BoardAdvice::show;
  /// Of the last picture, as shares of its width and height.
  std::vector<Eigen::Vector2d> corners = {};
  int taken = 0;   ///< views
  int wanted = 0;  ///< views, at least
  LensCoverage coverage = {};
};

/// A look as the API has it.
nlohmann::json to_json(const BoardLook& look);

/// Takes a view of a board that is held before a camera whenever it stands still in a new place.
class BoardWatch {
 public:
  /// @param lens  an estimate of the camera's, from which the boards' tilt is computed
  explicit BoardWatch(const Intrinsics& lens);

  /// Looks at the next picture, of the lens's size. @return whether its view was taken
  bool see(const Picture& picture);

  const BoardLook& look() const { return look_; }
  const std::vector<BoardView>& views() const { return views_; }

  /// Whether all views that are wanted were taken, or so many that more do not help.
  bool is_complete() const;

 private:
  /// Position and orientation of a board.
  struct Hold {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // pixels, of what is seen
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double size = 0;  // pixels, of a square
  };

  bool is_still(const BoardView& view) const;
  bool is_new(const Hold& hold) const;
  bool adds_cells(const BoardView& view) const;
  bool is_tilted() const;
  bool is_covered() const;
  BoardAdvice what_is_missing() const;

  Intrinsics lens_;
  BoardLook look_ = {};
  BoardView last_ = {};
  int still_pictures_ = 0;
  std::vector<BoardView> views_ = {};
  std::vector<Hold> holds_ = {};
};

}  // namespace octurn
