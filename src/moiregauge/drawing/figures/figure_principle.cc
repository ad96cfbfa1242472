// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_principle.h"

#include <cmath>

#include <fmt/format.h>

#include "moiregauge/drawing/plots/plot.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::figure {
namespace {

struct DrawnCurve {
  std::vector<double> x, y;
};

Image<double> grating(const PrincipleFigure& f, double moved_px) {
  Image<double> picture(f.width_px, 2 * f.sampling_pitch_px);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x)
      picture.at(x, y) = 125.0 + 85.0 * std::cos(kTwoPi * (x - moved_px) / f.pitch_px);
  }
  return picture;
}

DrawnCurve row_of(const Image<double>& picture) {
  DrawnCurve curve;
  for (int x = 0; x < picture.width(); ++x) {
    curve.x.push_back(x);
    curve.y.push_back(picture.at(x, 0));
  }
  return curve;
}

// Returns every T-th pixel from `start` on: the moiré fringe as sampled by Eq. (2).
DrawnCurve sampled(const Image<double>& picture, int start, int sampling_pitch_px) {
  DrawnCurve curve;
  for (int x = start; x < picture.width(); x += sampling_pitch_px) {
    curve.x.push_back(x);
    curve.y.push_back(picture.at(x, 0));
  }
  return curve;
}

// Returns the phase of the moiré fringe: the field's phase without the carrier of the sampling. At jumps of 2 pi, x is
// NaN and no line is drawn.
DrawnCurve moire_phase(const Image<double>& picture, int sampling_pitch_px) {
  const FringeField field = sampling_moire(picture.view(), Axis::kX, sampling_pitch_px);
  DrawnCurve curve;
  for (int i = 0; i < field.fringe.width(); ++i) {
    const double x = i + field.margin;
    const double phase = wrapped(std::arg(field.fringe.at(i, 0)) - kTwoPi * x / sampling_pitch_px);
    const bool jumps = !curve.y.empty() && std::abs(phase - curve.y.back()) > kPi;
    curve.x.push_back(jumps ? std::nan("") : x);
    curve.y.push_back(phase);
  }
  return curve;
}

// Returns the displacement by Eq. (4): d = -P (phase after - phase before) / 2 pi.
DrawnCurve displacement(const DrawnCurve& before, const DrawnCurve& after, double pitch_px) {
  DrawnCurve curve;
  for (std::size_t i = 0; i < before.x.size(); ++i) {
    curve.x.push_back(std::isfinite(before.x[i]) ? before.x[i] : after.x[i]);
    curve.y.push_back(-pitch_px * wrapped(after.y[i] - before.y[i]) / kTwoPi);
  }
  return curve;
}

Series series(std::string name, DrawnCurve curve, Colour colour, Mark mark = Mark::kLine) {
  return {.name = std::move(name),
          .x = std::move(curve.x),
          .y = std::move(curve.y),
          .colour = colour,
          .mark = mark,
          .width = mark == Mark::kDots ? 1.5 : 0.9};
}

void draw_principle(Canvas& canvas, const PrincipleFigure& f) {
  const auto still = grating(f, 0.0), moved = grating(f, f.moved_px);
  const DrawnCurve before = moire_phase(still, f.sampling_pitch_px), after = moire_phase(moved, f.sampling_pitch_px);
  const int step = f.sampling_pitch_px;
  std::vector<Panel> panels{
      {.letter = "(a)",
       .title = fmt::format("Grating of pitch P = {:.0f} px, one image row", f.pitch_px),
       .y_label = "Grey level",
       .series = {series("before", row_of(still), kBlue),
                  series(fmt::format("moved by {:.0f} px", f.moved_px), row_of(moved), kVermilion)},
       .y_range = Range{0.0, 255.0}},
      {.letter = "(b)",
       .title = fmt::format("Sampled every T = {} px, a moiré fringe {:.0f} times as long", step,
                            step / std::abs(f.pitch_px - step)),
       .y_label = "Grey level",
       .series = {series("before", sampled(still, 0, step), kBlue),
                  series("moved", sampled(moved, 0, step), kVermilion),
                  series("", sampled(still, 0, step), kBlue, Mark::kDots),
                  series("", sampled(moved, 0, step), kVermilion, Mark::kDots)},
       .y_range = Range{0.0, 255.0}},
      {.letter = "(c)",
       .title = fmt::format("Phase of the moiré fringe, from {} such samples", step),
       .y_label = "Phase, rad",
       .series = {series("before", before, kBlue), series("moved", after, kVermilion)},
       .y_range = Range{-4.0, 4.0}},
      {.letter = "(d)",
       .title = "Displacement, P / 2π times the phase difference",
       .x_label = "x, px",
       .y_label = "d, px",
       .series = {series("", displacement(before, after, f.pitch_px), kBlack)},
       .y_range = Range{0.0, 2.0 * f.moved_px}},
  };
  double y = 4.0;
  for (Panel& panel : panels) {
    panel.x_range = Range{0.0, static_cast<double>(f.width_px)};
    const double height = panel.x_label.empty() ? 84.0 : 88.0;
    draw_panel(canvas, {4.0, y, kOneColumn - 8.0, height - 3.0}, panel);
    y += height;
  }
}

}  // namespace

Figure principle_of_sampling_moire(const PrincipleFigure& contents) {
  return {kOneColumn, 348.0, [contents](Canvas& canvas) { draw_principle(canvas, contents); }};
}

}  // namespace moiregauge::internal::figure
