#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace octurn {

/// What a board is printed on.
enum class Paper { a4, letter };

/// "a4", "letter"; nothing if it is neither.
std::optional<Paper> paper_named(std::string_view name);

/// The side of a printed board's squares, millimetres.
inline constexpr int board_square_mm = 15;

/// A board of black squares for `find_board`, 12 by 17 of them, of letter paper 12 by 16, as a PDF
/// of one page. A ruler of 100 mm stands below and one beside it: a printer that scales the page,
/// or one side of it, shows there. All lengths are exact at 100 %.
std::string board_pdf(Paper paper);

}  // namespace octurn
