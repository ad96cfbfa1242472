// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/draw_sheet.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <cairo.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::sheet {
namespace {

using figure::Align;
using figure::Canvas;
using figure::kBlack;
using figure::Letters;

constexpr double kHair = 0.15;  // mm, line width
constexpr figure::Colour kQuietGrey{0.45, 0.45, 0.45};
constexpr double kTextSize_mm = 2.8, kSmall_mm = 2.3, kNameSize_mm = 5.0;

const char* words_for(Pattern pattern) {
  switch (pattern) {
    case Pattern::kSquares:
      return "squares";
    case Pattern::kDots:
      return "dots";
    case Pattern::kLinesX:
      return "lines-x (vertical lines)";
    case Pattern::kLinesY:
      return "lines-y (horizontal lines)";
    case Pattern::kCheckerboard:
      return "checkerboard (two squares)";
    case Pattern::kCosine:
      return "cosine";
    default:
      return "grid";
  }
}

// Draws a ruler from (0, 0) to the right with ticks downwards. It is rotated for the left edge.
void draw_ruler(cairo_t* cr, double length, const char* axis) {
  Canvas canvas(cr);
  canvas.line({{0, 0}, {length, 0}}, {kBlack, kHair});
  const int ticks = static_cast<int>(std::lround(length / 10.0));
  for (int i = 0; i <= ticks; ++i) {
    const bool is_end = i == 0 || i == ticks;
    canvas.line({{10.0 * i, is_end ? -1.5 : 0.0}, {10.0 * i, is_end ? 3.0 : i == 5 ? 1.8 : 1.2}}, {kBlack, kHair});
  }
  canvas.text({0.5 * length, 4.3}, fmt::format("{}: {:.0f}.0 mm between the long ticks", axis, length),
              {Align::kCentre, kBlack, false, 0.0, kSmall_mm});
}

void draw_text(cairo_t* cr, const Sheet& sheet) {
  Canvas canvas(cr);
  const Paper& paper = sheet.paper;
  const Letters name =
      fitted(canvas, sheet.name, {Align::kLeft, kBlack, true, 0.0, kNameSize_mm}, 0.4 * paper.width_mm);
  canvas.text({kEdges.left, 11.0}, sheet.name, name);
  const double behind = kEdges.left + canvas.text_width(sheet.name, name) + 4.0;
  canvas.text({behind, 7.8}, role_of(sheet), {Align::kLeft, kBlack, false, 0.0, kTextSize_mm});
  canvas.text({behind, 11.4}, words_for_prints(sheet.markers), {Align::kLeft, kBlack, false, 0.0, kTextSize_mm});
  draw_up_arrow(cr, paper.width_mm - kEdges.right - 14.0, 11.4);
  draw_instructions(cr, paper);
}

// Draws the corners of the cut, and marks at the grating's centre lines for mounting it.
void draw_marks(cairo_t* cr, const Sheet& sheet, const Marker& marker) {
  Canvas canvas(cr);
  const Box box = extent_of(marker);
  const PagePoint low = on_page(sheet, {box.low.x - sheet.cut_mm, box.high.y + sheet.cut_mm});
  const PagePoint high = on_page(sheet, {box.high.x + sheet.cut_mm, box.low.y - sheet.cut_mm});
  const double arm = std::min(3.0, 0.3 * sheet.cut_mm);
  for (const double x : {low.x_mm, high.x_mm}) {
    for (const double y : {low.y_mm, high.y_mm}) {
      const double sx = x == low.x_mm ? arm : -arm, sy = y == low.y_mm ? arm : -arm;
      canvas.line({{x + sx, y}, {x, y}, {x, y + sy}}, {kQuietGrey, kHair});
    }
  }
  if (!marker.grating) return;
  const PagePoint at = on_page(sheet, marker.grating->centre);
  for (const double y : {low.y_mm, high.y_mm})
    canvas.line({{at.x_mm, y - 0.5 * arm}, {at.x_mm, y + 0.5 * arm}}, {kQuietGrey, kHair});
  for (const double x : {low.x_mm, high.x_mm})
    canvas.line({{x - 0.5 * arm, at.y_mm}, {x + 0.5 * arm, at.y_mm}}, {kQuietGrey, kHair});
}

// Draws a marker's name in the white below it, too small to affect the grating.
void draw_name(cairo_t* cr, const Sheet& sheet, const Marker& marker) {
  const Box box = extent_of(marker);
  const double size = std::clamp(0.28 * sheet.cut_mm, 1.0, kTextSize_mm);
  const PagePoint at = on_page(sheet, {box.high.x, box.low.y});
  Canvas canvas(cr);
  const Letters letters = fitted(canvas, marker.name, {Align::kRight, kQuietGrey, false, 0.0, size}, 0.4 * box.width());
  canvas.text({at.x_mm, at.y_mm + 0.5 * sheet.cut_mm + size}, marker.name, letters);
}

}  // namespace

void draw_rulers(cairo_t* cr, const Paper& paper) {
  const double below = paper.height_mm - 17.0;
  cairo_save(cr);
  cairo_translate(cr, kEdges.left, below);
  draw_ruler(cr, ruler_mm(paper.width_mm), "x");
  cairo_restore(cr);
  cairo_save(cr);
  cairo_translate(cr, 13.0, paper.height_mm - kEdges.bottom);
  cairo_rotate(cr, -std::acos(0.0));  // text reads upwards
  cairo_translate(cr, 0.0, -4.5);
  draw_ruler(cr, ruler_mm(paper.height_mm), "y");
  cairo_restore(cr);
}

void draw_up_arrow(cairo_t* cr, double x, double y) {
  Canvas canvas(cr);
  const double right = x + canvas.text_width("up", {Align::kLeft, kBlack, true, 0.0, kNameSize_mm}) + 2.5;
  canvas.text({x, y}, "up", {Align::kLeft, kBlack, true, 0.0, kNameSize_mm});
  canvas.line({{right, y}, {right, y - 5.0}}, {kBlack, 0.5});
  canvas.line({{right - 1.3, y - 3.2}, {right, y - 5.0}, {right + 1.3, y - 3.2}}, {kBlack, 0.5});
}

std::string role_of(const Sheet& sheet) {
  if (sheet.markers.size() > 1) {
    const auto targets = std::count_if(sheet.markers.begin(), sheet.markers.end(),
                                       [](const Marker& m) { return m.role == Role::kTarget; });
    const auto references = static_cast<long>(sheet.markers.size()) - targets;
    return fmt::format("{} reference{}, {} target{}", references, references == 1 ? "" : "s", targets,
                       targets == 1 ? "" : "s");
  }
  return sheet.markers.front().role == Role::kReference ? "reference: must not move" : "target: moves";
}

void draw_instructions(cairo_t* cr, const Paper& paper) {
  Canvas canvas(cr);
  canvas.text({kEdges.left, paper.height_mm - 8.3},
              "Print at 100 %, not \"fit to page\", on matt paper. Measure both rulers.",
              {Align::kLeft, kBlack, false, 0.0, kSmall_mm});
  canvas.text({kEdges.left, paper.height_mm - 5.2},
              fmt::format("Example: {0:.2f} mm instead of {1:.0f} is --print-scale 1.0012. Page: {2}, moiregauge.",
                          1.0012 * ruler_mm(paper.width_mm), ruler_mm(paper.width_mm), paper.name),
              {Align::kLeft, kBlack, false, 0.0, kSmall_mm});
}

figure::Letters fitted(Canvas& canvas, const std::string& words, Letters letters, double width) {
  letters.size *= std::min(1.0, width / std::max(1e-9, canvas.text_width(words, letters)));
  return letters;
}

double ruler_mm(double room_mm) { return std::clamp(10.0 * std::floor((room_mm - 40.0) / 10.0), 10.0, 100.0); }

std::string words_for_prints(const std::vector<Marker>& markers) {
  std::set<std::string> words;
  for (const Marker& marker : markers) {
    if (marker.grating)
      words.insert(fmt::format("pitch {:g} mm, {}", marker.grating->pitch_mm, words_for(marker.grating->pattern)));
  }
  return words.empty() ? "circle" : fmt::format("{}", fmt::join(words, "; "));
}

void draw_markers(cairo_t* cr, const Sheet& sheet, const Ink& ink) {
  paint_cosines(cr, sheet, ink);
  for (const Marker& marker : sheet.markers) {
    draw_marks(cr, sheet, marker);
    if (sheet.markers.size() > 1) draw_name(cr, sheet, marker);
    if (marker.grating && marker.grating->pattern != Pattern::kCosine)
      print_grating(cr, *marker.grating, on_page(sheet, marker.grating->centre), ink);
    if (marker.circle) print_circle(cr, marker.circle->diameter_mm, on_page(sheet, marker.circle->centre), ink);
  }
}

void draw_sheet(cairo_t* cr, const Sheet& sheet, const Ink& ink) {
  draw_markers(cr, sheet, ink);
  draw_rulers(cr, sheet.paper);
  draw_text(cr, sheet);
}

}  // namespace moiregauge::internal::sheet
