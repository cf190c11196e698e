#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace octurn {

/// The paper that a board is printed on.
enum class Paper { a4, letter };

/// The paper named "a4" or "letter"; nullopt for other names.
std::optional<Paper> paper_named(std::string_view name);

/// The side of a printed board's squares, millimetres.
inline constexpr int board_square_mm = 15;

// The sides that a user may tell instead, as measured.
inline constexpr double min_board_square_mm = 10;
inline constexpr double max_board_square_mm = 60;

/// A chessboard for `find_board`, 12 by 17 squares (12 by 16 on letter paper), as a PDF of one
/// page. Rulers of 100 mm below and beside it show whether the printer scaled the page, or one side
/// of it. All lengths are exact at 100 %.
std::string board_pdf(Paper paper);

}  // namespace octurn
