#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/lens.hpp"

namespace octurn {

/// What the person with a board is to do next.
enum class BoardAdvice {
  show,        ///< it is not seen
  hold_still,  ///< it moves
  tilt,        ///< it was taken so already, and never tilted far enough
  reach,       ///< it was taken so already, and a part of the picture has never shown it
  turn,        ///< it was taken so already: any other way will do
};

/// What somebody who holds a board is shown.
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

/// Takes views of a board that is held before a camera: each time that it stands still in a new
/// place.
class BoardWatch {
 public:
  /// @param lens  about that of the camera, to see how a board is tilted
  explicit BoardWatch(const Intrinsics& lens);

  /// Looks at the next picture, of the lens's size. @return whether its view was taken
  bool see(const Picture& picture);

  const BoardLook& look() const { return look_; }
  const std::vector<BoardView>& views() const { return views_; }

  /// Whether nothing is missing, or so much was taken that more does not help.
  bool is_complete() const;

 private:
  /// How a board is held.
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
