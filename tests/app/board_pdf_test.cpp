#include "calibration/board_pdf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace octurn {
namespace {

/// The lines of a PDF that end with a word.
std::vector<std::string> lines_ending(const std::string& pdf, const std::string& word) {
  std::vector<std::string> found;
  std::istringstream lines(pdf);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with(word)) {
      found.push_back(line);
    }
  }
  return found;
}

struct Rectangle {
  double x = 0;  // mm
  double y = 0;
  double width = 0;
  double height = 0;
};

std::vector<Rectangle> squares_of(const std::string& pdf) {
  std::vector<Rectangle> squares;
  for (const std::string& line : lines_ending(pdf, " re f")) {
    Rectangle square;
    std::istringstream(line) >> square.x >> square.y >> square.width >> square.height;
    squares.push_back(square);
  }
  return squares;
}

TEST(BoardPdf, HasEachSquareInItsSizeOnThePage) {
  for (const auto& [paper, width, height, count] :
       {std::tuple(Paper::a4, 210.0, 297.0, 102U), std::tuple(Paper::letter, 215.9, 279.4, 96U)}) {
    const std::vector<Rectangle> squares = squares_of(board_pdf(paper));
    EXPECT_EQ(squares.size(), count);
    for (const Rectangle& square : squares) {
      EXPECT_DOUBLE_EQ(square.width, 15);
      EXPECT_DOUBLE_EQ(square.height, 15);
      EXPECT_GE(square.x, 15 - 1e-9);  // printers leave a margin of at least 5 mm
      EXPECT_LE(square.x + 15, width - 15 + 1e-9);
      EXPECT_GE(square.y, 25);
      EXPECT_LE(square.y + 15, height - 10);
      // No two black squares share a side.
      EXPECT_EQ(std::ranges::count_if(
                    squares,
                    [&](const Rectangle& other) {
                      return std::abs(other.x - square.x) + std::abs(other.y - square.y) < 16;
                    }),
                1);
    }
  }
}

TEST(BoardPdf, HasAPageOfThePapersSizeInMillimetres) {
  const std::string pdf = board_pdf(Paper::letter);
  EXPECT_NE(pdf.find("/MediaBox [0 0 612 792]"), std::string::npos);  // 8.5 by 11 inches
  const std::vector<std::string> scale = lines_ending(pdf, " cm");
  ASSERT_EQ(scale.size(), 1U);
  EXPECT_NEAR(std::stod(scale.front()), 72 / 25.4, 1e-4);
}

TEST(BoardPdf, TellsWhereEachObjectBegins) {
  const std::string pdf = board_pdf(Paper::a4);
  const std::vector<std::string> places = lines_ending(pdf, " 00000 n ");
  ASSERT_EQ(places.size(), 5U);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string object = std::to_string(i + 1) + " 0 obj\n";
    EXPECT_EQ(pdf.substr(std::stoul(places[i]), object.size()), object);
  }
  const std::size_t table = std::stoul(pdf.substr(pdf.find("startxref\n") + 10));
  EXPECT_EQ(pdf.substr(table, 5), "xref\n");
  const std::size_t stream = pdf.find("stream\n") + 7;
  const std::size_t length = std::stoul(pdf.substr(pdf.find("/Length ") + 8));
  EXPECT_EQ(pdf.substr(stream + length, 9), "endstream");
}

TEST(BoardPdf, KnowsItsPapersByName) {
  EXPECT_EQ(paper_named("a4"), Paper::a4);
  EXPECT_EQ(paper_named("letter"), Paper::letter);
  EXPECT_FALSE(paper_named("A3"));
}

}  // namespace
}  // namespace octurn
