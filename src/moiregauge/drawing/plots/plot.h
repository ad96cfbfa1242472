// SPDX-License-Identifier: Apache-2.0
// Draws curves over axes: one panel of a figure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/drawing/plots/marks.h"
#include "moiregauge/drawing/plots/plot_axis.h"
#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

struct Series {
  std::string name{};  // in the legend; empty: not listed
  std::vector<double> x{}, y{};
  std::vector<double> low{}, high{};  // limits of the band around y, one per y; empty: none
  Colour colour = kBlack;
  Mark mark = Mark::kLine;
  double width = 0.9;  // the line's width, or the radius of a mark
  bool on_right_axis = false;
};

struct Note {
  double x = 0.0, y = 0.0;  // on the axes; the text is above
  std::string words{};
};

struct Panel {
  std::string letter{};  // "(a)"
  std::string title{};
  std::string x_label{};  // with its unit; empty: no numbers under the axis either
  std::string y_label{};
  std::string right_label{};  // empty: no right axis
  std::vector<Series> series{};
  std::vector<Note> notes{};
  std::optional<Range> x_range{}, y_range{};                 // none: range of the series
  Scale x_scale = Scale::kLinear, y_scale = Scale::kLinear;  // the right axis is always linear
};

// Margins around the axes inside the box of draw_panel, points.
inline constexpr double kLeftRoom = 40.0, kRightRoom = 8.0, kRightAxisRoom = 32.0;

// Draws a panel. It has a legend if more than one series has a name.
void draw_panel(Canvas& canvas, Box box, const Panel& panel);
// Draws the named series in one line. `at` is the start of its baseline.
void draw_legend(Canvas& canvas, Spot at, const std::vector<Series>& series);

}  // namespace moiregauge::internal::figure
