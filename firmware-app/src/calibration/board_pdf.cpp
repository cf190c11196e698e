#include "calibration/board_pdf.hpp"

#include <array>
#include <cstddef>
#include <sstream>
#include <vector>

namespace octurn {
namespace {

constexpr double points_per_mm = 72 / 25.4;
constexpr int ruler_mm = 100;

/// A page and the board on it, millimetres.
struct Layout {
  double width = 0;
  double height = 0;
  int columns = 0;
  int rows = 0;
  double bottom = 0;  // lower edge of the board
};

Layout make_layout(Paper paper) {
  return paper == Paper::a4
             ? Layout{.width = 210, .height = 297, .columns = 12, .rows = 17, .bottom = 30}
             : Layout{.width = 215.9, .height = 279.4, .columns = 12, .rows = 16, .bottom = 28};
}

/// Drawing commands of PDF, lengths in millimetres from the page's bottom left.
class Drawing {
 public:
  Drawing() { out_ << points_per_mm << " 0 0 " << points_per_mm << " 0 0 cm\n0 g 0.2 w\n"; }

  void fill(double x, double y, double width, double height) {
    out_ << x << ' ' << y << ' ' << width << ' ' << height << " re f\n";
  }

  void line(double x0, double y0, double x1, double y1) {
    out_ << x0 << ' ' << y0 << " m " << x1 << ' ' << y1 << " l S\n";
  }

  void text(double x, double y, std::string_view words) {
    out_ << "BT /F 3.5 Tf " << x << ' ' << y << " Td (" << words << ") Tj ET\n";
  }

  std::string commands() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

void draw_board(Drawing& drawing, const Layout& layout, double left) {
  constexpr double side = board_square_mm;
  for (int row = 0; row < layout.rows; ++row) {
    for (int column = row % 2; column < layout.columns; column += 2) {
      drawing.fill(left + column * side, layout.bottom + row * side, side, side);
    }
  }
}

void draw_rulers(Drawing& drawing, const Layout& layout, double left) {
  const double below = layout.bottom - 12;
  const double beside = left - 9;
  drawing.line(left, below, left + ruler_mm, below);
  drawing.line(beside, layout.bottom, beside, layout.bottom + ruler_mm);
  for (int mm = 0; mm <= ruler_mm; mm += 10) {
    const double tick = mm % ruler_mm == 0 ? 3 : 1.5;
    drawing.line(left + mm, below, left + mm, below + tick);
    drawing.line(beside, layout.bottom + mm, beside + tick, layout.bottom + mm);
  }
  drawing.text(left + ruler_mm + 3, below, "100 mm");
  drawing.text(beside - 3, layout.bottom + ruler_mm + 3, "100");
  drawing.text(left + 130, below, "Octurn  " + std::to_string(board_square_mm) + " mm  100 %");
}

/// Assembles a PDF file from the bodies of its objects, which are numbered from 1. The first one is
/// the document catalog.
std::string to_pdf(const std::vector<std::string>& objects) {
  std::ostringstream out;
  out << "%PDF-1.4\n";
  std::vector<std::streamoff> places;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    places.push_back(out.tellp());
    out << i + 1 << " 0 obj\n" << objects[i] << "\nendobj\n";
  }
  const std::streamoff table = out.tellp();
  out << "xref\n0 " << objects.size() + 1 << "\n0000000000 65535 f \n";
  for (const std::streamoff place : places) {
    const std::string digits = std::to_string(place);
    out << std::string(10 - digits.size(), '0') << digits << " 00000 n \n";
  }
  out << "trailer\n<< /Size " << objects.size() + 1 << " /Root 1 0 R >>\nstartxref\n"
      << table << "\n%%EOF\n";
  return out.str();
}

}  // namespace

std::optional<Paper> paper_named(std::string_view name) {
  return name == "a4"       ? std::optional(Paper::a4)
         : name == "letter" ? std::optional(Paper::letter)
                            : std::nullopt;
}

std::string board_pdf(Paper paper) {
  const Layout layout = make_layout(paper);
  const double left = (layout.width - layout.columns * board_square_mm) / 2;
  Drawing drawing;
  draw_board(drawing, layout, left);
  draw_rulers(drawing, layout, left);
  const std::string commands = drawing.commands();
  std::ostringstream page;
  page << "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " << layout.width * points_per_mm << ' '
       << layout.height * points_per_mm
       << "] /Resources << /Font << /F 5 0 R >> >> /Contents 4 0 R >>";
  // PrintScaling None: print dialogues propose the true size.
  return to_pdf(
      {"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
       "<< /Type /Pages /Kids [3 0 R] /Count 1 >>", page.str(),
       "<< /Length " + std::to_string(commands.size()) + " >>\nstream\n" + commands + "endstream",
       "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"});
}

}  // namespace octurn
