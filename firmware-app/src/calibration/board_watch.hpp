#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "octurn/lens.hpp"

namespace octurn {

/// Next instruction to the person who holds a calibration board.
enum class BoardAdvice {
  show,        ///< no board was detected
  hold_still,  ///< the board moves
  tilt,        ///< this place has a view; no two views differ enough in tilt
  reach,       ///< this place has a view; parts of the picture have no corners yet
  turn,        ///< this place has a view; any other place will do
};

/// Feedback for the person who holds a board.
struct BoardLook {
  BoardAdvice advice = BoardAdvice::show;
  /// Corners in the last picture, as fractions of its width and height.
  std::vector<Eigen::Vector2d> corners = {};
  int taken = 0;   ///< number of views
  int wanted = 0;  ///< minimum number of views
  LensCoverage coverage = {};
};

/// JSON of the feedback, for the API.
nlohmann::json to_json(const BoardLook& look);

/// Collects views of a board that a person holds in front of a camera. A view is taken when the
/// board stands still in a new place, or covers new cells of the picture.
class BoardWatch {
 public:
  using FindBoard = BoardView (*)(const Picture& picture);

  /// @param lens    estimate of the camera's intrinsics, used to compute the boards' tilt
  /// @param find    finds a board in a picture
  /// @param wanted  minimum number of views
  explicit BoardWatch(const Intrinsics& lens, FindBoard find = find_board, int wanted = 12);

  /// Processes the next picture, whose size must be that of the lens.
  /// @return whether its view was taken
  bool see(const Picture& picture);

  /// Whether a picture shows the board where the view that was taken last shows it.
  bool shows_last_view(const Picture& picture) const;

  /// Drops the view that was taken last: the board moved meanwhile.
  void drop_last_view();

  const BoardLook& look() const { return look_; }
  const std::vector<BoardView>& views() const { return views_; }

  /// Whether the wanted views are taken and cover tilt and picture, or the maximum number of views
  /// is reached.
  bool is_complete() const;

 private:
  /// Position and orientation of a board.
  struct Hold {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // pixels: mean of the corners
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double size = 0;  // pixels: mean side of the squares
  };

  bool is_same(const BoardView& view, const BoardView& other) const;
  bool is_new(const Hold& hold) const;
  bool adds_cells(const BoardView& view) const;
  bool is_tilted() const;
  bool is_covered() const;
  BoardAdvice what_is_missing() const;

  Intrinsics lens_;
  FindBoard find_;
  BoardLook look_ = {};
  BoardView last_ = {};
  int still_pictures_ = 0;
  std::vector<BoardView> views_ = {};
  std::vector<Hold> holds_ = {};
};

}  // namespace octurn
