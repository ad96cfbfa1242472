// SPDX-License-Identifier: Apache-2.0
// Curves over an axis: one panel of a figure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/drawing/plots/marks.h"
#include "moiregauge/drawing/plots/plot_axis.h"
#include "moiregauge/drawing/surface/canvas.h"

namespace moiregauge::internal::figure {

struct Series {
  std::string name{};  // in the legend; empty: not there
  std::vector<double> x{}, y{};
  std::vector<double> low{}, high{};  // of the band round y, one per y; empty: none
  Colour colour = kBlack;
  Mark mark = Mark::kLine;
  double width = 0.9;  // of the line, or the radius of a mark
  bool on_right_axis = false;
};

struct Note {
  double x = 0.0, y = 0.0;  // on the axes; the words stand above
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
  std::optional<Range> x_range{}, y_range{};                 // else what the series need
  Scale x_scale = Scale::kLinear, y_scale = Scale::kLinear;  // the right axis is always linear
};

// Room round the axes inside the box given to draw_panel.
inline constexpr double kLeftRoom = 40.0, kRightRoom = 8.0, kRightAxisRoom = 32.0;

// With a legend of its own when more than one series has a name.
void draw_panel(Canvas& canvas, Box box, const Panel& panel);
// The named series in one line that begins at `at`, the foot of its letters.
void draw_legend(Canvas& canvas, Spot at, const std::vector<Series>& series);

}  // namespace moiregauge::internal::figure
