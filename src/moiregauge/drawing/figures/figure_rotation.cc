// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_rotation.h"

#include <algorithm>
#include <array>
#include <utility>

#include "moiregauge/drawing/plots/plot.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kRotationMargin = 4.0, kRotationHeight = 176.0, kLegendLine = 11.0,
                 kLegendHeight = 2.0 * kLegendLine + 4.0;
constexpr double kBetweenRows = 6.0;
constexpr std::size_t kColumns = 2;
constexpr double kMarkRim = 0.08;  // relative to the axes: keeps the outermost marks complete
constexpr double kMarkRadius = 1.7, kPublishedRadius = 2.4, kCrossRadius = 3.0, kLargestWidth = 1.1, kRmsWidth = 0.6;
constexpr std::array kMethodColours{kVermilion, kBlue, kGreen, kPurple};
constexpr std::array kTurns{Turn::kOneAxis, Turn::kAllAxes};

Colour method_colour(std::size_t method) { return kMethodColours[method % kMethodColours.size()]; }
Mark mark_of(Turn turn) { return turn == Turn::kOneAxis ? Mark::kDots : Mark::kSquares; }
Mark open_mark_of(Turn turn) { return turn == Turn::kOneAxis ? Mark::kOpenDots : Mark::kOpenSquares; }

// Adds one curve per kind of rotation, because the other kind at the same angle is another experiment.
void add_curve(std::vector<Series>& series, const RotationCurve& curve, Turn turn, Colour colour) {
  Series largest{.colour = colour, .width = kLargestWidth};
  Series rms{.colour = colour, .mark = Mark::kDashed, .width = kRmsWidth};
  Series lost{.colour = kBlack, .mark = Mark::kCrosses, .width = kCrossRadius};
  for (const RotationPoint& p : curve.points) {
    if (p.turn != turn) continue;
    for (Series* s : {&largest, &rms}) s->x.push_back(p.rotation_deg);
    largest.y.push_back(p.largest_mm);
    rms.y.push_back(p.rms_mm);
    if (!p.some_lost) continue;
    lost.x.push_back(p.rotation_deg);
    lost.y.push_back(p.largest_mm);
  }
  Series marks = largest;
  marks.mark = mark_of(turn);
  marks.width = kMarkRadius;
  for (Series* s : {&rms, &largest, &marks, &lost}) series.push_back(std::move(*s));
}

Series published(const RotationFigure& f, Turn turn) {
  Series series{.colour = kBlack, .mark = open_mark_of(turn), .width = kPublishedRadius};
  for (const PublishedError& p : f.published) {
    if (p.turn != turn) continue;
    series.x.push_back(p.rotation_deg);
    series.y.push_back(p.error_mm);
  }
  return series;
}

Panel panel_of(const RotationFigure& f, std::size_t place) {
  Panel panel{.letter = {'(', static_cast<char>('a' + place), ')'},
              .title = f.lenses[place].lens,
              .x_label = "Camera rotation, °",
              .y_label = "Error of dy, mm",
              .x_scale = Scale::kLog,
              .y_scale = Scale::kLog};
  const auto& methods = f.lenses[place].methods;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    for (const Turn turn : kTurns) add_curve(panel.series, methods[m], turn, method_colour(m));
  }
  for (const Turn turn : kTurns) panel.series.push_back(published(f, turn));
  return panel;
}

// Sets the same axes for all panels, so that lenses can be compared.
void share_axes(std::vector<Panel>& panels) {
  std::vector<double> x, y;
  for (const Panel& panel : panels) {
    for (const Series& s : panel.series) {
      x.insert(x.end(), s.x.begin(), s.x.end());
      y.insert(y.end(), s.y.begin(), s.y.end());
    }
  }
  for (Panel& panel : panels) {
    panel.x_range = extent_of(x, Scale::kLog, kMarkRim);
    panel.y_range = extent_of(y, Scale::kLog, kMarkRim);
  }
}

void draw_key(Canvas& canvas, const RotationFigure& f) {
  std::vector<Series> colours, marks;
  for (std::size_t m = 0; m < f.lenses.front().methods.size(); ++m)
    colours.push_back({.name = f.lenses.front().methods[m].method, .colour = method_colour(m), .width = kLargestWidth});
  colours.push_back({.name = "largest error of the run", .colour = kGrey, .width = kLargestWidth});
  colours.push_back({.name = "rms of the run", .colour = kGrey, .mark = Mark::kDashed, .width = kRmsWidth});
  marks.push_back({.name = "about x", .mark = Mark::kDots, .width = kMarkRadius});
  marks.push_back({.name = "about x, y and z", .mark = Mark::kSquares, .width = kMarkRadius});
  marks.push_back({.name = "the paper, about x", .mark = Mark::kOpenDots, .width = kPublishedRadius});
  marks.push_back({.name = "the paper, about x, y and z", .mark = Mark::kOpenSquares, .width = kPublishedRadius});
  marks.push_back({.name = "some frames lost", .mark = Mark::kCrosses, .width = kCrossRadius});
  const double x = kRotationMargin + kLeftRoom;
  draw_legend(canvas, {x, kRotationMargin + kLegendLine - 3.0}, colours);
  draw_legend(canvas, {x, kRotationMargin + 2.0 * kLegendLine - 3.0}, marks);
}

}  // namespace

Figure error_against_rotation(const RotationFigure& contents) {
  const std::size_t rows = (contents.lenses.size() + kColumns - 1) / kColumns;
  const double height = 2.0 * kRotationMargin + kLegendHeight + static_cast<double>(rows) * kRotationHeight;
  return {kTwoColumns, height, [contents](Canvas& canvas) {
            draw_key(canvas, contents);
            std::vector<Panel> panels;
            for (std::size_t i = 0; i < contents.lenses.size(); ++i) panels.push_back(panel_of(contents, i));
            share_axes(panels);
            const double width = (kTwoColumns - 2.0 * kRotationMargin) / static_cast<double>(kColumns);
            for (std::size_t i = 0; i < panels.size(); ++i) {
              const std::size_t row = i / kColumns, column = i % kColumns;
              const double x = kRotationMargin + static_cast<double>(column) * width;
              const double y = kRotationMargin + kLegendHeight + static_cast<double>(row) * kRotationHeight;
              draw_panel(canvas, {x, y, width, kRotationHeight - kBetweenRows}, panels[i]);
            }
          }};
}

}  // namespace moiregauge::internal::figure
