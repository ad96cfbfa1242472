// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kTitleRoom = 11.0, kLegendRoom = 10.0, kRim = 0.04;
constexpr double kTickLength = 2.5, kSmallTickLength = 1.4, kTickSpacing = 11.0, kTickSpacingAcross = 20.0;
constexpr Colour kGridColour{0.87, 0.87, 0.87}, kZeroColour{0.8, 0.8, 0.8};

std::vector<double> y_of(const std::vector<Series>& series, bool right) {
  std::vector<double> all;
  for (const Series& s : series) {
    if (s.on_right_axis != right) continue;
    for (const auto* values : {&s.y, &s.low, &s.high}) all.insert(all.end(), values->begin(), values->end());
  }
  return all;
}

std::vector<double> x_of(const std::vector<Series>& series) {
  std::vector<double> all;
  for (const Series& s : series) all.insert(all.end(), s.x.begin(), s.x.end());
  return all;
}

// Position and scales of the axes.
struct Axes {
  Box box;
  PlotAxis x, y, right;
  [[nodiscard]] double at_x(double v) const { return box.x + box.width * x.place(v); }
  [[nodiscard]] double at_y(double v, bool on_right) const {
    return box.y + box.height * (1.0 - (on_right ? right : y).place(v));
  }
};

int most_ticks(double length, double spacing) { return std::max(3, static_cast<int>(length / spacing)); }

Axes axes_of(Box box, const Panel& panel, std::size_t named) {
  Axes axes;
  const double top = kTitleRoom + (named > 1 ? kLegendRoom : 0.0), bottom = panel.x_label.empty() ? 5.0 : 22.0;
  const double side = panel.right_label.empty() ? kRightRoom : kRightAxisRoom;
  axes.box = {box.x + kLeftRoom, box.y + top, box.width - kLeftRoom - side, box.height - top - bottom};
  axes.x = {panel.x_range.value_or(extent_of(x_of(panel.series), panel.x_scale, 0.0)), panel.x_scale};
  if (!(axes.x.range.high > axes.x.range.low)) axes.x.range.high = axes.x.range.low + 1.0;
  const int most = most_ticks(axes.box.height, kTickSpacing);
  // With a margin, so that no point is on the frame.
  axes.y = to_whole_ticks({extent_of(y_of(panel.series, false), panel.y_scale, kRim), panel.y_scale}, most);
  if (panel.y_range) axes.y.range = *panel.y_range;
  axes.right = to_whole_ticks({extent_of(y_of(panel.series, true), Scale::kLinear, 0.0)}, most);
  return axes;
}

// Formats 10⁻⁶ instead of 0.000001 for axes with many decades.
std::string power_of_ten(double value) {
  constexpr std::array kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int power = static_cast<int>(std::lround(std::log10(value)));
  std::string text = power < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(power))) text += kDigits[static_cast<std::size_t>(digit - '0')];
  return text;
}

constexpr double kManyDecades = 1e4;

void draw_side(Canvas& canvas, const Axes& axes, const std::string& label, bool right) {
  const double edge = right ? axes.box.x + axes.box.width : axes.box.x, out = right ? 1.0 : -1.0;
  double widest = 0.0;
  const PlotAxis& axis = right ? axes.right : axes.y;
  const bool by_powers = axis.scale == Scale::kLog && axis.range.high > kManyDecades * axis.range.low;
  for (Tick& tick : ticks_of(axis, most_ticks(axes.box.height, kTickSpacing))) {
    if (by_powers && !tick.label.empty()) tick.label = power_of_ten(tick.value);
    const double y = axes.at_y(tick.value, right);
    canvas.line({{edge, y}, {edge - out * (tick.label.empty() ? kSmallTickLength : kTickLength), y}}, {});
    widest = std::max(widest, canvas.text_width(tick.label));
    canvas.text({edge + out * 3.0, y + 2.5}, tick.label, {.align = right ? Align::kLeft : Align::kRight});
  }
  const double x = edge + out * (widest + (right ? 5.0 + kTextSize : 7.0));
  canvas.text({x, axes.box.y + 0.5 * axes.box.height}, label, {.align = Align::kCentre, .angle_rad = -0.5 * kPi});
}

void draw_bottom(Canvas& canvas, const Axes& axes, const std::string& label) {
  const double edge = axes.box.y + axes.box.height;
  for (const Tick& tick : ticks_of(axes.x, most_ticks(axes.box.width, kTickSpacingAcross))) {
    const double x = axes.at_x(tick.value);
    canvas.line({{x, edge}, {x, edge - (tick.label.empty() ? kSmallTickLength : kTickLength)}}, {});
    if (!label.empty()) canvas.text({x, edge + 9.0}, tick.label, {.align = Align::kCentre});
  }
  canvas.text({axes.box.x + 0.5 * axes.box.width, edge + 18.5}, label, {.align = Align::kCentre});
}

// Draws lines at the decades of a logarithmic axis, or at the zero of a linear axis.
void draw_guides(Canvas& canvas, const Axes& axes) {
  const auto across = [&](double v, Colour colour) {
    const double y = axes.at_y(v, false);
    canvas.line({{axes.box.x, y}, {axes.box.x + axes.box.width, y}}, {colour, 0.4});
  };
  if (axes.y.scale == Scale::kLinear) {
    if (axes.y.range.low < 0.0 && axes.y.range.high > 0.0) across(0.0, kZeroColour);
    return;
  }
  for (const Tick& tick : ticks_of(axes.y, most_ticks(axes.box.height, kTickSpacing))) {
    if (!tick.label.empty()) across(tick.value, kGridColour);
  }
}

void draw_band(Canvas& canvas, const Axes& axes, const Series& series) {
  constexpr double kOpacity = 0.28;
  std::vector<Spot> above, below;
  for (std::size_t i = 0; i < series.low.size(); ++i) {
    const double x = axes.at_x(series.x[i]);
    above.push_back({x, axes.at_y(series.high[i], series.on_right_axis)});
    below.push_back({x, axes.at_y(series.low[i], series.on_right_axis)});
  }
  canvas.band(above, below, series.colour, kOpacity);
}

void draw_series(Canvas& canvas, const Axes& axes, const Series& series) {
  draw_band(canvas, axes, series);
  std::vector<Spot> points;
  for (std::size_t i = 0; i < series.x.size(); ++i)
    points.push_back({axes.at_x(series.x[i]), axes.at_y(series.y[i], series.on_right_axis)});
  if (joins_points(series.mark))
    return canvas.line(points, {series.colour, series.width, series.mark == Mark::kDashed});
  for (const Spot& p : points) draw_mark(canvas, series.mark, p, series.width, series.colour);
}

}  // namespace

void draw_legend(Canvas& canvas, Spot at, const std::vector<Series>& series) {
  constexpr double kSample = 14.0, kSmallestMark = 1.2;
  const double middle = at.y - 2.5;
  for (const Series& s : series) {
    if (s.name.empty()) continue;
    if (joins_points(s.mark)) {
      canvas.line({{at.x, middle}, {at.x + kSample, middle}}, {s.colour, s.width, s.mark == Mark::kDashed});
    } else {
      draw_mark(canvas, s.mark, {at.x + 0.5 * kSample, middle}, std::max(kSmallestMark, s.width), s.colour);
    }
    canvas.text({at.x + kSample + 3.0, at.y}, s.name);
    at.x += kSample + 12.0 + canvas.text_width(s.name);
  }
}

void draw_panel(Canvas& canvas, Box box, const Panel& panel) {
  const auto named =
      std::count_if(panel.series.begin(), panel.series.end(), [](const Series& s) { return !s.name.empty(); });
  const Axes axes = axes_of(box, panel, static_cast<std::size_t>(named));
  canvas.text({box.x, box.y + 7.5}, panel.letter, {.bold = true});
  canvas.text({axes.box.x, box.y + 7.5}, panel.title);
  canvas.clip(axes.box);
  draw_guides(canvas, axes);
  for (const Series& s : panel.series) draw_series(canvas, axes, s);
  for (const Note& note : panel.notes)
    canvas.text({axes.at_x(note.x), axes.at_y(note.y, false) - 3.0}, note.words, {.align = Align::kCentre});
  canvas.unclip();
  canvas.frame(axes.box, {});
  draw_side(canvas, axes, panel.y_label, false);
  if (!panel.right_label.empty()) draw_side(canvas, axes, panel.right_label, true);
  draw_bottom(canvas, axes, panel.x_label);
  if (named > 1) draw_legend(canvas, {axes.box.x, axes.box.y - 4.0}, panel.series);
}

}  // namespace moiregauge::internal::figure
