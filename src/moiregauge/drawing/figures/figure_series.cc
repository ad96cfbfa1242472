// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_series.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "moiregauge/drawing/plots/plot.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kTruthHeight = 104.0, kCurveHeight = 104.0, kErrorHeight = 78.0, kSeriesMargin = 4.0;
constexpr std::array kLensColours{kBlue, kVermilion, kGreen, kPurple};
constexpr double kTimeRim_s = 0.4;

// Smaller dots for later lenses, so that coinciding points show both.
double dot_of(std::size_t lens) { return lens == 0 ? 1.2 : 0.75; }

Panel truth_panel(const SeriesFigure& f) {
  Panel panel{.letter = "(a)",
              .title = fmt::format("True displacement and camera angle, {}", f.rotation),
              .x_label = "Time, s",
              .y_label = "dy, mm",
              .right_label = "Angle, °",
              .y_range = Range{-0.2, 2.2}};
  panel.series.push_back({.name = "displacement", .x = f.time_s, .y = f.true_mm, .colour = kBlack, .width = 1.1});
  panel.series.push_back({.name = "camera angle",
                          .x = f.time_s,
                          .y = f.camera_deg,
                          .colour = kOrange,
                          .mark = Mark::kDashed,
                          .on_right_axis = true});
  return panel;
}

Panel displacement_panel(const SeriesFigure& f, const MethodCurves& method, std::size_t place) {
  Panel panel{.letter = fmt::format("({})", static_cast<char>('b' + place)),
              .title = fmt::format("Measured: {}", method.method),
              .x_label = "",
              .y_label = "dy, mm"};
  panel.series.push_back({.name = "true", .x = f.time_s, .y = f.true_mm, .colour = kGrey, .width = 2.2});
  for (std::size_t i = 0; i < method.lenses.size(); ++i) {
    const MeasuredCurve& c = method.lenses[i];
    panel.series.push_back({.name = c.lens,
                            .x = c.time_s,
                            .y = c.displacement_mm,
                            .colour = kLensColours[i % kLensColours.size()],
                            .mark = Mark::kDots,
                            .width = dot_of(i)});
  }
  return panel;
}

Panel error_panel(const MethodCurves& method) {
  Panel panel{.letter = "", .title = "Measured minus true", .x_label = "Time, s", .y_label = "Error, mm"};
  for (std::size_t i = 0; i < method.lenses.size(); ++i) {
    const MeasuredCurve& c = method.lenses[i];
    panel.series.push_back({.name = "",
                            .x = c.time_s,
                            .y = c.error_mm,
                            .colour = kLensColours[i % kLensColours.size()],
                            .mark = Mark::kDots,
                            .width = dot_of(i)});
  }
  return panel;
}

}  // namespace

Figure displacement_over_time(const SeriesFigure& contents) {
  const double height =
      2 * kSeriesMargin + kTruthHeight + static_cast<double>(contents.methods.size()) * (kCurveHeight + kErrorHeight);
  return {kOneColumn, height, [contents](Canvas& canvas) {
            const Range time{contents.time_s.front() - kTimeRim_s, contents.time_s.back() + kTimeRim_s};
            double y = kSeriesMargin;
            const auto put = [&](Panel panel, double panel_height) {
              panel.x_range = time;
              // All panels of the column have the width of the panel with two axes, so that their times are aligned.
              const double side = panel.right_label.empty() ? kRightAxisRoom - kRightRoom : 0.0;
              draw_panel(canvas, {kSeriesMargin, y, kOneColumn - 2 * kSeriesMargin - side, panel_height - 4.0}, panel);
              y += panel_height;
            };
            put(truth_panel(contents), kTruthHeight);
            for (std::size_t i = 0; i < contents.methods.size(); ++i) {
              put(displacement_panel(contents, contents.methods[i], i), kCurveHeight);
              put(error_panel(contents.methods[i]), kErrorHeight);
            }
          }};
}

}  // namespace moiregauge::internal::figure
