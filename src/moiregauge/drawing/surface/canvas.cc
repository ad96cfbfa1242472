// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/surface/canvas.h"

#include <cmath>

#include <cairo.h>

#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::figure {
namespace {

void choose_letters(cairo_t* cr, const Letters& letters) {
  choose_font(cr, letters.size, letters.bold ? Weight::kBold : Weight::kNormal);
}

}  // namespace

void Canvas::pen(Stroke stroke) {
  constexpr double kDashes[] = {3.0, 2.0};
  cairo_set_dash(cr_, kDashes, stroke.dashed ? 2 : 0, 0.0);
  cairo_set_line_width(cr_, stroke.width);
  cairo_set_source_rgb(cr_, stroke.colour.r, stroke.colour.g, stroke.colour.b);
  cairo_stroke(cr_);
}

// Draws a line, interrupted at points that are not finite.
void Canvas::line(const std::vector<Spot>& points, Stroke stroke) {
  bool is_down = false;
  for (const Spot& p : points) {
    const bool is_number = std::isfinite(p.x) && std::isfinite(p.y);
    if (is_number && is_down) cairo_line_to(cr_, p.x, p.y);
    if (is_number && !is_down) cairo_move_to(cr_, p.x, p.y);
    is_down = is_number;
  }
  pen(stroke);
}

void Canvas::band(const std::vector<Spot>& above, const std::vector<Spot>& below, Colour colour, double opacity) {
  cairo_set_source_rgba(cr_, colour.r, colour.g, colour.b, opacity);
  const auto is_number = [&](std::size_t i) {
    return std::isfinite(above[i].x) && std::isfinite(above[i].y) && std::isfinite(below[i].y);
  };
  for (std::size_t first = 0; first < above.size(); ++first) {
    if (!is_number(first)) continue;
    std::size_t end = first;
    for (; end < above.size() && is_number(end); ++end) cairo_line_to(cr_, above[end].x, above[end].y);
    for (std::size_t i = end; i-- > first;) cairo_line_to(cr_, below[i].x, below[i].y);
    cairo_close_path(cr_);
    cairo_fill(cr_);
    first = end;
  }
}

void Canvas::dot(Spot at, double radius, Colour colour) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) return;
  cairo_new_sub_path(cr_);
  cairo_arc(cr_, at.x, at.y, radius, 0, kTwoPi);
  cairo_set_source_rgb(cr_, colour.r, colour.g, colour.b);
  cairo_fill(cr_);
}

void Canvas::frame(Box box, Stroke stroke) {
  cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
  pen(stroke);
}

void Canvas::fill(Box box, Colour colour) {
  cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
  cairo_set_source_rgb(cr_, colour.r, colour.g, colour.b);
  cairo_fill(cr_);
}

void Canvas::ellipse(Spot centre, double a, double b, double angle_rad, Stroke stroke) {
  cairo_save(cr_);
  cairo_translate(cr_, centre.x, centre.y);
  cairo_rotate(cr_, angle_rad);
  cairo_scale(cr_, a, b);
  cairo_new_sub_path(cr_);
  cairo_arc(cr_, 0, 0, 1, 0, kTwoPi);
  cairo_restore(cr_);
  pen(stroke);
}

double Canvas::text_width(const std::string& words, const Letters& letters) {
  choose_letters(cr_, letters);
  cairo_text_extents_t box;
  cairo_text_extents(cr_, words.c_str(), &box);
  return box.x_advance;
}

void Canvas::text(Spot at, const std::string& words, const Letters& letters) {
  const double width = text_width(words, letters);
  cairo_save(cr_);
  cairo_translate(cr_, at.x, at.y);
  cairo_rotate(cr_, letters.angle_rad);
  cairo_move_to(cr_,
                letters.align == Align::kLeft     ? 0.0
                : letters.align == Align::kCentre ? -0.5 * width
                                                  : -width,
                0.0);
  cairo_set_source_rgb(cr_, letters.colour.r, letters.colour.g, letters.colour.b);
  cairo_show_text(cr_, words.c_str());
  cairo_restore(cr_);
  cairo_new_path(cr_);
}

void Canvas::picture(ImageView<std::uint8_t> pixels, Box box) {
  const Surface surface = grey_surface(pixels);
  cairo_save(cr_);
  cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
  cairo_clip(cr_);
  cairo_translate(cr_, box.x, box.y);
  cairo_scale(cr_, box.width / pixels.width, box.height / pixels.height);
  cairo_set_source_surface(cr_, surface.get(), 0, 0);
  cairo_pattern_set_extend(cairo_get_source(cr_), CAIRO_EXTEND_PAD);  // avoids a pale rim
  cairo_paint(cr_);
  cairo_restore(cr_);
}

void Canvas::clip(Box box) {
  cairo_save(cr_);
  cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
  cairo_clip(cr_);
}

void Canvas::unclip() { cairo_restore(cr_); }

}  // namespace moiregauge::internal::figure
