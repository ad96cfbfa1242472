// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/draw_tile.h"

#include <algorithm>
#include <string>

#include <cairo.h>
#include <fmt/format.h>

#include "moiregauge/drawing/surface/canvas.h"
#include "moiregauge/sheet/draw_sheet.h"

namespace moiregauge::internal::sheet {
namespace {

using figure::Align;
using figure::Canvas;
using figure::kBlack;

constexpr double kTick_mm = 0.2;                        // line width of marks
constexpr double kTickGap_mm = 0.5, kTickEnd_mm = 4.0;  // distances of their ends from the part
constexpr double kMarkText_mm = 2.3;
constexpr figure::Colour kPartGrey{0.45, 0.45, 0.45}, kFill{0.75, 0.75, 0.75};

struct Window {
  double left, top, right, bottom;  // mm on the page
};

Window window_of(const Tiling& tiling) {
  return {kEdges.left, kEdges.top, kEdges.left + tiling.width_mm, kEdges.top + tiling.height_mm};
}

// Draws a mark across the part at x, outside of it, with a word at its upper end.
void mark_upright(Canvas& canvas, const Window& w, double x, const char* word) {
  canvas.line({{x, w.top - kTickGap_mm}, {x, w.top - kTickEnd_mm + 0.6}}, {kBlack, kTick_mm});
  canvas.line({{x, w.bottom + kTickGap_mm}, {x, w.bottom + kTickEnd_mm}}, {kBlack, kTick_mm});
  const double side = x < 0.5 * (w.left + w.right) ? 1.0 : -1.0;  // towards the middle, away from the corner's tick
  for (const double y : {w.top - 1.0, w.bottom + 3.4})
    canvas.text({x + 0.8 * side, y}, word,
                {side > 0.0 ? Align::kLeft : Align::kRight, kBlack, false, 0.0, kMarkText_mm});
}

// Draws a mark along the part at height y, outside of it.
void mark_level(Canvas& canvas, const Window& w, double y, const char* word) {
  canvas.line({{w.left - kTickGap_mm, y}, {w.left - kTickEnd_mm, y}}, {kBlack, kTick_mm});
  canvas.line({{w.right + kTickGap_mm, y}, {w.right + kTickEnd_mm, y}}, {kBlack, kTick_mm});
  canvas.text({w.left - 0.7, y - 0.7}, word, {Align::kRight, kBlack, false, 0.0, kMarkText_mm});
  canvas.text({w.right + 0.6, y - 0.7}, word, {Align::kLeft, kBlack, false, 0.0, kMarkText_mm});
}

void draw_corners(Canvas& canvas, const Window& w) {
  for (const double x : {w.left, w.right}) {
    const double side = x == w.left ? -1.0 : 1.0;
    for (const double y : {w.top, w.bottom}) {
      const double up = y == w.top ? -1.0 : 1.0;
      canvas.line({{x + side * kTickGap_mm, y}, {x + side * 3.0, y}}, {kPartGrey, kTick_mm});
      canvas.line({{x, y + up * kTickGap_mm}, {x, y + up * 3.0}}, {kPartGrey, kTick_mm});
    }
  }
}

void draw_joints(Canvas& canvas, const Tiling& tiling, int column, int row) {
  constexpr double kJoint = 0.5 * kTileOverlap_mm;  // in the middle of the overlap
  const Window w = window_of(tiling);
  draw_corners(canvas, w);
  if (column > 0) mark_upright(canvas, w, w.left + kJoint, "cut");
  if (column + 1 < tiling.columns) mark_upright(canvas, w, w.right - kJoint, "join");
  if (row > 0) mark_level(canvas, w, w.top + kJoint, "cut");
  if (row + 1 < tiling.rows) mark_level(canvas, w, w.bottom - kJoint, "join");
}

// Draws all parts as a small map at the lower right, with this one filled.
void draw_map(Canvas& canvas, const Tiling& tiling, int column, int row) {
  constexpr double kMapHigh_mm = 13.0, kMapWide_mm = 22.0;
  const double cell =
      std::min(kMapHigh_mm / tiling.rows / tiling.height_mm, kMapWide_mm / tiling.columns / tiling.width_mm);
  const double wide = cell * tiling.width_mm, high = cell * tiling.height_mm;
  const double left = tiling.paper.width_mm - kEdges.right - wide * tiling.columns;
  const double top = tiling.paper.height_mm - 5.0 - high * tiling.rows;
  for (int r = 0; r < tiling.rows; ++r) {
    for (int c = 0; c < tiling.columns; ++c) {
      const double x = left + c * wide, y = top + r * high;
      if (c == column && r == row) canvas.fill({x, y, wide, high}, kFill);
      canvas.line({{x, y}, {x + wide, y}, {x + wide, y + high}, {x, y + high}, {x, y}}, {kBlack, kTick_mm});
    }
  }
}

void draw_head(Canvas& canvas, const Sheet& sheet, int column, int row) {
  const Tiling& tiling = *sheet.tiling;
  const std::string name =
      fmt::format("{}, part {} of {}", sheet.name, row * tiling.columns + column + 1, tiling.columns * tiling.rows);
  const auto letters = fitted(canvas, name, {Align::kLeft, kBlack, true, 0.0, 5.0}, 0.5 * tiling.paper.width_mm);
  canvas.text({kEdges.left, 7.6}, name, letters);
  canvas.text({kEdges.left + canvas.text_width(name, letters) + 4.0, 7.6},
              fmt::format("{}; {}; column {} of {}, row {} of {}", role_of(sheet), words_for_prints(sheet.markers),
                          column + 1, tiling.columns, row + 1, tiling.rows),
              {Align::kLeft, kBlack, false, 0.0, kMarkText_mm});
  canvas.text(
      {kEdges.left, 10.7},
      "Cut from tick to tick at \"cut\". Glue that edge on the ticks \"join\" of the part to the left or above.",
      {Align::kLeft, kBlack, false, 0.0, kMarkText_mm});
}

}  // namespace

PagePoint corner_of_tile(const Tiling& tiling, int column, int row) {
  return {column * (tiling.width_mm - kTileOverlap_mm), row * (tiling.height_mm - kTileOverlap_mm)};
}

void draw_tile(cairo_t* cr, const Sheet& sheet, int column, int row, const Ink& ink) {
  const Tiling& tiling = *sheet.tiling;
  const PagePoint corner = corner_of_tile(tiling, column, row);
  cairo_save(cr);
  cairo_rectangle(cr, kEdges.left, kEdges.top, tiling.width_mm, tiling.height_mm);
  cairo_clip(cr);
  cairo_translate(cr, -corner.x_mm, -corner.y_mm);
  draw_markers(cr, sheet, ink);
  cairo_restore(cr);
  Canvas canvas(cr);
  draw_joints(canvas, tiling, column, row);
  draw_map(canvas, tiling, column, row);
  draw_head(canvas, sheet, column, row);
  draw_up_arrow(cr, tiling.paper.width_mm - kEdges.right - 14.0, 10.0);
  draw_rulers(cr, tiling.paper);
  draw_instructions(cr, tiling.paper);
}

}  // namespace moiregauge::internal::sheet
