// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/overlay_pen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "moiregauge/drawing/surface/surface.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::overlay {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  }
  return lines;
}

constexpr double kPad = 3.0;  // units around the letters of a label

}  // namespace

Surface page_with(ImageView<std::uint8_t> picture, int scale, int width, int height) {
  Surface page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy);
  const Context context(cairo_create(page.get()), cairo_destroy);
  cairo_set_source_rgb(context.get(), 0.11, 0.12, 0.14);
  cairo_paint(context.get());
  cairo_scale(context.get(), scale, scale);
  constexpr int kBand = 128;  // rows at a time: a whole copy would need 4 bytes per pixel
  for (int y = 0; y < picture.height; y += kBand) {
    const int rows = std::min(kBand, picture.height - y);
    const Surface grey = grey_surface(picture.part(0, y, picture.width, rows));
    cairo_set_source_surface(context.get(), grey.get(), 0, y);
    // Show pixels without interpolation.
    cairo_pattern_set_filter(cairo_get_source(context.get()), CAIRO_FILTER_NEAREST);
    cairo_rectangle(context.get(), 0, y, picture.width, rows);
    cairo_fill(context.get());
  }
  return page;
}

double Box::shared_with(const Box& o) const {
  const double w = std::min(x + width, o.x + o.width) - std::max(x, o.x);
  const double h = std::min(y + height, o.y + o.height) - std::max(y, o.y);
  return w > 0.0 && h > 0.0 ? w * h : 0.0;
}

double Box::distance_to(double px, double py) const {
  return std::hypot(std::max({x - px, 0.0, px - x - width}), std::max({y - py, 0.0, py - y - height}));
}

Pen::Pen(cairo_t* cr, double unit, int scale) : cr_(cr), unit_(unit), scale_(scale) { letters(letters_, false); }

void Pen::letters(double units, bool bold) {
  letters_ = units;
  choose_font(cr_, letters_ * unit_, bold ? Weight::kBold : Weight::kNormal);
}

void Pen::ellipse(const DetectedCircle& c) {
  const double minor = c.diameter_px * std::sqrt(c.axis_ratio), major = minor / c.axis_ratio;
  cairo_save(cr_);
  cairo_translate(cr_, page_x(c.centre.x), page_y(c.centre.y));
  cairo_rotate(cr_, c.angle_rad);
  cairo_scale(cr_, 0.5 * scale_ * major, 0.5 * scale_ * minor);
  cairo_new_sub_path(cr_);
  cairo_arc(cr_, 0, 0, 1, 0, kTwoPi);
  cairo_restore(cr_);
  stroke();
}

void Pen::circle(ImagePoint centre, double diameter_px) {
  cairo_new_sub_path(cr_);
  cairo_arc(cr_, page_x(centre.x), page_y(centre.y), 0.5 * scale_ * diameter_px, 0, kTwoPi);
  stroke();
}

void Pen::cross(ImagePoint p, double half_units) {
  const double half = half_units * unit_, x = page_x(p.x), y = page_y(p.y);
  cairo_move_to(cr_, x - half, y);
  cairo_line_to(cr_, x + half, y);
  cairo_move_to(cr_, x, y - half);
  cairo_line_to(cr_, x, y + half);
  stroke();
}

void Pen::polygon(const std::vector<ImagePoint>& points) {
  for (const ImagePoint& p : points) cairo_line_to(cr_, page_x(p.x), page_y(p.y));
  cairo_close_path(cr_);
  stroke();
}

void Pen::line(ImagePoint a, ImagePoint b) {
  cairo_move_to(cr_, page_x(a.x), page_y(a.y));
  cairo_line_to(cr_, page_x(b.x), page_y(b.y));
  stroke();
}

void Pen::arrow(ImagePoint a, ImagePoint b) {
  const double x = page_x(b.x), y = page_y(b.y), angle = std::atan2(b.y - a.y, b.x - a.x), head = 7.0 * unit_;
  cairo_move_to(cr_, page_x(a.x), page_y(a.y));
  cairo_line_to(cr_, x, y);
  for (const double side : {-0.45, 0.45}) {
    cairo_move_to(cr_, x, y);
    cairo_line_to(cr_, x - head * std::cos(angle + side), y - head * std::sin(angle + side));
  }
  stroke();
}

void Pen::dot(ImagePoint p, double radius_units) {
  cairo_new_sub_path(cr_);
  cairo_arc(cr_, page_x(p.x), page_y(p.y), radius_units * unit_, 0, kTwoPi);
  cairo_set_source_rgb(cr_, colour_.r, colour_.g, colour_.b);
  cairo_fill(cr_);
}

void Pen::bar(double x0, double x1, double y, double width_units, double end_units) {
  for (const double x : {x0, x1}) {
    cairo_move_to(cr_, x, y - end_units * unit_);
    cairo_line_to(cr_, x, y + end_units * unit_);
  }
  stroke();
  const double before = std::exchange(width_, width_units);
  cairo_move_to(cr_, x0, y);
  cairo_line_to(cr_, x1, y);
  stroke();
  width_ = before;
}

double Pen::covered(const Box& box) const {
  double area = 0.0;
  for (const Box& other : taken_) area += box.shared_with(other);
  return area;
}

void Pen::stroke() {
  const double dashes[] = {4.0 * unit_, 3.0 * unit_};
  cairo_set_dash(cr_, dashes, dashed_ ? 2 : 0, 0.0);
  cairo_set_line_width(cr_, (width_ + 1.8) * unit_);  // a dark outline under the colour
  cairo_set_source_rgba(cr_, 0, 0, 0, 0.55);
  cairo_stroke_preserve(cr_);
  cairo_set_line_width(cr_, width_ * unit_);
  cairo_set_source_rgb(cr_, colour_.r, colour_.g, colour_.b);
  cairo_stroke(cr_);
}

double Pen::text_width(const std::string& line) const {
  cairo_text_extents_t box;
  cairo_text_extents(cr_, line.c_str(), &box);
  return box.x_advance;
}

Box Pen::plate(double x, double y, const std::string& text) const {
  const auto lines = lines_of(text);
  double width = 0.0;
  for (const std::string& line : lines) width = std::max(width, text_width(line));
  const double pad = kPad * unit_;
  return {x - pad, y - letters_ * unit_, width + 2 * pad, static_cast<double>(lines.size()) * line_height()};
}

void Pen::label(double x, double y, const std::string& text, const Box& within) {
  Box box = plate(x, y, text);
  const double dx = std::clamp(box.x, within.x, std::max(within.x, within.x + within.width - box.width)) - box.x;
  const double dy = std::clamp(box.y, within.y, std::max(within.y, within.y + within.height - box.height)) - box.y;
  box.x += dx;
  box.y += dy;
  cairo_set_source_rgba(cr_, 0, 0, 0, 0.65);
  cairo_rectangle(cr_, box.x, box.y, box.width, box.height);
  cairo_fill(cr_);
  cairo_set_source_rgb(cr_, colour_.r, colour_.g, colour_.b);
  double foot = y + dy;
  for (const std::string& line : lines_of(text)) {
    cairo_move_to(cr_, x + dx, foot);
    cairo_show_text(cr_, line.c_str());
    foot += line_height();
  }
  cairo_new_path(cr_);
  taken_.push_back(box);
}

void Pen::label_outside(const std::vector<ImagePoint>& corners, const std::string& text, const Box& within,
                        double most_covered) {
  const Box about = page_box(corners), size = plate(0.0, 0.0, text);
  const double gap = 4.0 * unit_, left = about.x, right = about.x + about.width, top = about.y,
               bottom = about.y + about.height;
  const double middle = 0.5 * (left + right - size.width), half = 0.5 * (top + bottom - size.height);
  const double above = top - gap - size.height, below = bottom + gap, right_of = right + gap,
               before = left - gap - size.width;
  const std::pair<double, double> places[] = {{left, above},
                                              {middle, above},
                                              {right - size.width, above},
                                              {left, below},
                                              {middle, below},
                                              {right_of, half},
                                              {before, half},
                                              {right_of, top},
                                              {before, top},
                                              {right_of, below},
                                              {right_of, bottom - size.height}};
  double best_cost = 1e300, best_covered = 0.0;
  std::pair<double, double> best = places[0];
  for (const auto& place : places) {
    const Box box{place.first, place.second, size.width, size.height};
    // Parts outside `within` count as covered, because the label would be shifted.
    const double covered = size.width * size.height - box.shared_with(within) + this->covered(box);
    double away = 1e300;
    for (const ImagePoint& p : corners) away = std::min(away, box.distance_to(page_x(p.x), page_y(p.y)));
    const double cost = covered + 0.2 * line_height() * away;
    if (cost < best_cost - 0.5) {
      best_cost = cost;
      best_covered = covered;
      best = place;
    }
  }
  if (best_covered > most_covered * size.width * size.height) return;
  label(best.first - size.x, best.second - size.y, text, within);
}

Box Pen::page_box(const std::vector<ImagePoint>& points) const {
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  for (const ImagePoint& p : points) {
    x0 = std::min(x0, page_x(p.x));
    x1 = std::max(x1, page_x(p.x));
    y0 = std::min(y0, page_y(p.y));
    y1 = std::max(y1, page_y(p.y));
  }
  return {x0, y0, x1 - x0, y1 - y0};
}

std::vector<ImagePoint> corners_round(ImagePoint c, double diameter_px) {
  const double r = 0.5 * diameter_px;
  return {{c.x - r, c.y - r}, {c.x + r, c.y - r}, {c.x + r, c.y + r}, {c.x - r, c.y + r}};
}

std::vector<ImagePoint> outline(const View& view, BoardPoint centre, double width, double height, double angle) {
  std::vector<ImagePoint> points;
  for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double x = 0.5 * sx * width, y = 0.5 * sy * height;
    points.push_back(view(
        {centre.x + x * std::cos(angle) - y * std::sin(angle), centre.y + x * std::sin(angle) + y * std::cos(angle)}));
  }
  return points;
}

}  // namespace moiregauge::internal::overlay
