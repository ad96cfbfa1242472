// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plot.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge::figure {
namespace {

constexpr double kTitleRoom = 11.0, kLegendRoom = 10.0, kTickLength = 2.5, kTickSpacing = 11.0, kRim = 0.04;

Range extent_of(const std::vector<Series>& series, bool right, bool of_x) {
  Range range{1.0, 0.0};
  for (const Series& s : series) {
    if (!of_x && s.on_right_axis != right) continue;
    for (const double v : of_x ? s.x : s.y) {
      if (!std::isfinite(v)) continue;
      const bool is_first = range.low > range.high;
      range = is_first ? Range{v, v} : Range{std::min(range.low, v), std::max(range.high, v)};
    }
  }
  if (range.low > range.high) return {0.0, 1.0};
  const double rim = of_x || right ? 0.0 : kRim * (range.high - range.low);  // so that no point lies on the frame
  return {range.low - rim, range.high + rim};
}

// Where the axes stand, and what they count.
struct Axes {
  Box box;
  Range x, y, right;
  [[nodiscard]] double at_x(double v) const { return box.x + box.width * (v - x.low) / (x.high - x.low); }
  [[nodiscard]] double at_y(double v, bool on_right) const {
    const Range& r = on_right ? right : y;
    return box.y + box.height * (r.high - v) / (r.high - r.low);
  }
};

int most_ticks(double length, double spacing) { return std::max(3, static_cast<int>(length / spacing)); }

Axes axes_of(Box box, const Panel& panel, std::size_t named) {
  Axes axes;
  const double top = kTitleRoom + (named > 1 ? kLegendRoom : 0.0), bottom = panel.x_label.empty() ? 5.0 : 22.0;
  const double side = panel.right_label.empty() ? kRightRoom : kRightAxisRoom;
  axes.box = {box.x + kLeftRoom, box.y + top, box.width - kLeftRoom - side, box.height - top - bottom};
  axes.x = panel.x_range.value_or(extent_of(panel.series, false, true));
  if (!(axes.x.high > axes.x.low)) axes.x.high = axes.x.low + 1.0;
  const auto covered = [&](bool right) {
    const auto ticks = nice_ticks(extent_of(panel.series, right, false), most_ticks(axes.box.height, kTickSpacing));
    return Range{ticks.front(), ticks.back()};
  };
  axes.y = panel.y_range.value_or(covered(false));
  axes.right = covered(true);
  return axes;
}

void draw_side(Canvas& canvas, const Axes& axes, const std::string& label, bool right) {
  const Range& range = right ? axes.right : axes.y;
  const auto ticks = nice_ticks(range, most_ticks(axes.box.height, kTickSpacing));
  const double edge = right ? axes.box.x + axes.box.width : axes.box.x, out = right ? 1.0 : -1.0;
  double widest = 0.0;
  for (const double v : ticks) {
    if (v < range.low - 1e-9 || v > range.high + 1e-9) continue;
    const double y = axes.at_y(v, right);
    canvas.line({{edge, y}, {edge - out * kTickLength, y}}, {});
    const std::string words = tick_label(v, ticks[1] - ticks[0]);
    widest = std::max(widest, canvas.text_width(words));
    canvas.text({edge + out * 3.0, y + 2.5}, words, {.align = right ? Align::kLeft : Align::kRight});
  }
  const double x = edge + out * (widest + (right ? 5.0 + kTextSize : 7.0));
  canvas.text({x, axes.box.y + 0.5 * axes.box.height}, label, {.align = Align::kCentre, .angle_rad = -0.5 * kPi});
}

void draw_bottom(Canvas& canvas, const Axes& axes, const std::string& label) {
  const auto ticks = nice_ticks(axes.x, most_ticks(axes.box.width, 20.0));
  const double edge = axes.box.y + axes.box.height;
  for (const double v : ticks) {
    if (v < axes.x.low - 1e-9 || v > axes.x.high + 1e-9) continue;
    canvas.line({{axes.at_x(v), edge}, {axes.at_x(v), edge - kTickLength}}, {});
    if (!label.empty())
      canvas.text({axes.at_x(v), edge + 9.0}, tick_label(v, ticks[1] - ticks[0]), {.align = Align::kCentre});
  }
  canvas.text({axes.box.x + 0.5 * axes.box.width, edge + 18.5}, label, {.align = Align::kCentre});
}

void draw_series(Canvas& canvas, const Axes& axes, const Series& series) {
  std::vector<Spot> points;
  for (std::size_t i = 0; i < series.x.size(); ++i)
    points.push_back({axes.at_x(series.x[i]), axes.at_y(series.y[i], series.on_right_axis)});
  if (series.mark != Mark::kDots)
    return canvas.line(points, {series.colour, series.width, series.mark == Mark::kDashed});
  for (const Spot& p : points) canvas.dot(p, series.width, series.colour);
}

void draw_legend(Canvas& canvas, const Axes& axes, const Panel& panel) {
  double x = axes.box.x;
  const double y = axes.box.y - 4.0;
  for (const Series& s : panel.series) {
    if (s.name.empty()) continue;
    if (s.mark == Mark::kDots) {
      canvas.dot({x + 7.0, y - 2.5}, std::max(1.2, s.width), s.colour);
    } else {
      canvas.line({{x, y - 2.5}, {x + 14.0, y - 2.5}}, {s.colour, s.width, s.mark == Mark::kDashed});
    }
    canvas.text({x + 17.0, y}, s.name);
    x += 17.0 + canvas.text_width(s.name) + 9.0;
  }
}

}  // namespace

void draw_panel(Canvas& canvas, Box box, const Panel& panel) {
  const auto named =
      std::count_if(panel.series.begin(), panel.series.end(), [](const Series& s) { return !s.name.empty(); });
  const Axes axes = axes_of(box, panel, static_cast<std::size_t>(named));
  canvas.text({box.x, box.y + 7.5}, panel.letter, {.bold = true});
  canvas.text({axes.box.x, box.y + 7.5}, panel.title);
  canvas.clip(axes.box);
  if (axes.y.low < 0.0 && axes.y.high > 0.0) {
    const double zero = axes.at_y(0.0, false);
    canvas.line({{axes.box.x, zero}, {axes.box.x + axes.box.width, zero}}, {{0.8, 0.8, 0.8}, 0.4});
  }
  for (const Series& s : panel.series) draw_series(canvas, axes, s);
  canvas.unclip();
  canvas.frame(axes.box, {});
  draw_side(canvas, axes, panel.y_label, false);
  if (!panel.right_label.empty()) draw_side(canvas, axes, panel.right_label, true);
  draw_bottom(canvas, axes, panel.x_label);
  if (named > 1) draw_legend(canvas, axes, panel);
}

}  // namespace moiregauge::figure
