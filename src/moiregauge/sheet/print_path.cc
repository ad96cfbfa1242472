// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/print_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <cairo.h>

#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/image/image.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::sheet {
namespace {

constexpr double kMaxDots = 40e6;

struct Span {
  double from, to;
};

// Returns the dark lines: a quarter of a pitch to either side of (n + offset) pitches, clipped at `half`.
std::vector<Span> bars(double pitch, double offset, double half) {
  std::vector<Span> found;
  const int count = static_cast<int>(std::ceil(half / pitch)) + 1;
  for (int n = -count; n <= count; ++n) {
    const double middle = (n + offset) * pitch;
    const double from = std::max(middle - 0.25 * pitch, -half), to = std::min(middle + 0.25 * pitch, half);
    if (to > from) found.push_back({from, to});
  }
  return found;
}

void add_crossings(cairo_t* cr, const std::vector<Span>& columns, const std::vector<Span>& rows) {
  for (const Span& y : rows) {
    for (const Span& x : columns) cairo_rectangle(cr, x.from, y.from, x.to - x.from, y.to - y.from);
  }
}

// Adds the dots that are completely inside the grating.
void add_dots(cairo_t* cr, const Grating& g) {
  const double p = g.pitch_mm, radius = 0.25 * p;
  const auto last = [&](double size) { return static_cast<int>(std::floor((0.5 * size - radius) / p + 1e-9)); };
  const int nx = last(g.width_mm), ny = last(g.height_mm);
  for (int j = -ny; j <= ny; ++j) {
    for (int i = -nx; i <= nx; ++i) {
      cairo_new_sub_path(cr);
      cairo_arc(cr, i * p, j * p, radius, 0.0, kTwoPi);
    }
  }
}

// Adds the dark areas. An inverted grating exchanges dark and light, up to its edge.
void add_pattern(cairo_t* cr, const Grating& g, bool inverted) {
  const double x = 0.5 * g.width_mm, y = 0.5 * g.height_mm, p = g.pitch_mm;
  const std::vector<Span> all_x{{-x, x}}, all_y{{-y, y}};
  const double offset = inverted ? 0.5 : 0.0;
  const std::vector<Span> columns = bars(p, offset, x), rows = bars(p, offset, y);
  switch (g.pattern) {
    case Pattern::kLinesX:
      return add_crossings(cr, columns, all_y);
    case Pattern::kLinesY:
      return add_crossings(cr, all_x, rows);
    case Pattern::kCheckerboard:
      add_crossings(cr, bars(p, 0.0, x), rows);
      return add_crossings(cr, bars(p, 0.5, x), bars(p, 0.5 - offset, y));
    case Pattern::kDots:
      if (inverted) cairo_rectangle(cr, -x, -y, 2.0 * x, 2.0 * y);
      return add_dots(cr, g);
    default:
      break;
  }
  // Crossed lines are the union of columns and rows, squares their intersection. Each is the inverse of the other.
  if ((g.pattern == Pattern::kSquares) != inverted) return add_crossings(cr, columns, rows);
  add_crossings(cr, columns, all_y);
  add_crossings(cr, all_x, rows);
}

void choose_grey(cairo_t* cr, double grey) { cairo_set_source_rgb(cr, grey, grey, grey); }

bool is_cosine(const Marker& marker) { return marker.grating && marker.grating->pattern == Pattern::kCosine; }

void add_outline(cairo_t* cr, const Grating& g, PagePoint centre) {
  cairo_save(cr);
  cairo_translate(cr, centre.x_mm, centre.y_mm);
  cairo_rotate(cr, -g.angle_rad);
  cairo_rectangle(cr, -0.5 * g.width_mm, -0.5 * g.height_mm, g.width_mm, g.height_mm);
  cairo_restore(cr);
}

struct Raster {
  double dot_mm;
  Image<std::uint8_t> grey;
};

Raster raster_for(const Paper& paper) {
  const double area = paper.width_mm * paper.height_mm;
  const double dot = std::max(25.4 / 300.0, std::sqrt(area / kMaxDots));
  const auto dots = [&](double mm) { return static_cast<int>(std::ceil(mm / dot)); };
  return {dot, Image<std::uint8_t>(dots(paper.width_mm), dots(paper.height_mm), 255)};
}

// Paints every dot of the grating, and a margin for the clipping.
void paint_cosine(Raster& raster, const Grating& g, PagePoint centre, const Ink& ink) {
  const double c = std::cos(g.angle_rad), s = std::sin(g.angle_rad), dot = raster.dot_mm;
  const double reach = 0.5 * std::hypot(g.width_mm, g.height_mm) + 2.0 * dot;
  const auto first = [&](double mm) { return std::max(0, static_cast<int>((mm - reach) / dot)); };
  const auto last = [&](double mm, int size) { return std::min(size - 1, static_cast<int>((mm + reach) / dot)); };
  for (int j = first(centre.y_mm); j <= last(centre.y_mm, raster.grey.height()); ++j) {
    for (int i = first(centre.x_mm); i <= last(centre.x_mm, raster.grey.width()); ++i) {
      const double x = (i + 0.5) * dot - centre.x_mm, y = centre.y_mm - (j + 0.5) * dot;
      const double along = c * x + s * y, across = c * y - s * x;
      if (std::abs(along) > 0.5 * g.width_mm + dot || std::abs(across) > 0.5 * g.height_mm + dot) continue;
      const double grey = cosine_grey(along / g.pitch_mm, across / g.pitch_mm, ink);
      raster.grey.at(i, j) = static_cast<std::uint8_t>(std::lround(255.0 * grey));
    }
  }
}

}  // namespace

double cosine_grey(double x, double y, const Ink& ink) {
  const double wave = 0.25 * (std::cos(kTwoPi * x) + std::cos(kTwoPi * y));
  return std::pow(1.0 - ink.density * (0.5 - (ink.inverted ? -wave : wave)), 1.0 / ink.gamma);
}

void paint_cosines(cairo_t* cr, const Sheet& sheet, const Ink& ink) {
  if (std::none_of(sheet.markers.begin(), sheet.markers.end(), is_cosine)) return;
  Raster raster = raster_for(sheet.paper);
  cairo_save(cr);
  cairo_new_path(cr);
  for (const Marker& marker : sheet.markers) {
    if (!is_cosine(marker)) continue;
    const PagePoint centre = on_page(sheet, marker.grating->centre);
    paint_cosine(raster, *marker.grating, centre, ink);
    add_outline(cr, *marker.grating, centre);
  }
  cairo_clip(cr);
  const Surface surface = grey_surface(raster.grey.view());
  cairo_scale(cr, raster.dot_mm, raster.dot_mm);
  cairo_set_source_surface(cr, surface.get(), 0.0, 0.0);
  cairo_paint(cr);
  cairo_restore(cr);
}

void print_grating(cairo_t* cr, const Grating& grating, PagePoint centre, const Ink& ink) {
  cairo_save(cr);
  cairo_translate(cr, centre.x_mm, centre.y_mm);
  cairo_rotate(cr, -grating.angle_rad);  // counter-clockwise on a page with y downwards
  cairo_new_path(cr);
  choose_grey(cr, 1.0 - ink.density);
  // Dots are holes in an inverted grating. Crossing lines are filled once.
  cairo_set_fill_rule(cr, grating.pattern == Pattern::kDots ? CAIRO_FILL_RULE_EVEN_ODD : CAIRO_FILL_RULE_WINDING);
  add_pattern(cr, grating, ink.inverted);
  cairo_fill(cr);
  cairo_restore(cr);
}

void print_circle(cairo_t* cr, double diameter_mm, PagePoint centre, const Ink& ink) {
  cairo_new_path(cr);
  cairo_arc(cr, centre.x_mm, centre.y_mm, 0.5 * diameter_mm, 0.0, kTwoPi);
  choose_grey(cr, 1.0 - ink.density);
  cairo_fill(cr);
}

}  // namespace moiregauge::internal::sheet
