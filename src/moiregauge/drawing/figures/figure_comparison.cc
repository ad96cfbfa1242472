// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/drawing/plots/plot.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kComparisonWidth = 120.0 * 72.0 / 25.4, kComparisonHeight = 175.0, kComparisonRim = 3.0;
constexpr double kThin = 0.7, kPoint = 0.9, kGuide = 0.6;

Figure one_panel(Panel panel) {
  return {kComparisonWidth, kComparisonHeight, [panel = std::move(panel)](Canvas& canvas) {
            draw_panel(canvas,
                       {kComparisonRim, kComparisonRim, kComparisonWidth - 2.0 * kComparisonRim,
                        kComparisonHeight - 2.0 * kComparisonRim},
                       panel);
          }};
}

double usual_step(const Comparison& c) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < c.rows.size(); ++k) steps.push_back(c.rows[k].time_s - c.rows[k - 1].time_s);
  if (steps.empty()) return 0.0;
  std::nth_element(steps.begin(), steps.begin() + std::ssize(steps) / 2, steps.end());
  return steps[steps.size() / 2];
}

// Returns a curve over time, interrupted at gaps, with a band of `width_of` around `value_of`.
template <typename Value, typename Width>
Curve curve_over_time(const Comparison& c, Value value_of, Width width_of) {
  constexpr double kGap = 2.5;  // usual steps
  const double longest = kGap * usual_step(c), none = std::numeric_limits<double>::quiet_NaN();
  Curve curve;
  for (std::size_t k = 0; k < c.rows.size(); ++k) {
    const ComparedRow& row = c.rows[k];
    if (k > 0 && row.time_s - c.rows[k - 1].time_s > longest) {
      curve.x.push_back(row.time_s);
      for (auto* values : {&curve.y, &curve.low, &curve.high}) values->push_back(none);
    }
    curve.x.push_back(row.time_s);
    curve.y.push_back(value_of(row));
    curve.low.push_back(value_of(row) - width_of(row));
    curve.high.push_back(value_of(row) + width_of(row));
  }
  return thinned(curve);
}

Figure series_figure(const Comparison& c, const std::string& channel, const std::string& unit) {
  Panel panel{.title = fmt::format("{}: both records on one clock and one zero", channel),
              .x_label = "Time, s",
              .y_label = fmt::format("Value, {}", unit)};
  const auto no_width = [](const ComparedRow&) { return 0.0; };
  Curve reference = curve_over_time(
      c, [](const ComparedRow& row) { return row.reference; }, no_width);
  Curve measured = curve_over_time(
      c, [](const ComparedRow& row) { return row.measured; }, no_width);
  panel.series.push_back(
      {.name = "reference", .x = std::move(reference.x), .y = std::move(reference.y), .colour = kGrey, .width = 2.0});
  panel.series.push_back({.name = "moiregauge",
                          .x = std::move(measured.x),
                          .y = std::move(measured.y),
                          .colour = kVermilion,
                          .width = kThin});
  return one_panel(std::move(panel));
}

Figure difference_figure(const Comparison& c, const std::string& unit) {
  Panel panel{.title = fmt::format("Band: U = {:.2g} {} (k = 2, rms). It covers {:.0f} % of the rows",
                                   kComparisonCoverage * c.rms_u, unit, 100.0 * c.coverage),
              .x_label = "Time, s",
              .y_label = fmt::format("Difference, {}", unit)};
  Curve band = curve_over_time(
      c, [](const ComparedRow&) { return 0.0; }, [](const ComparedRow& row) { return kComparisonCoverage * row.u; });
  Curve difference = curve_over_time(
      c, [](const ComparedRow& row) { return row.difference; }, [](const ComparedRow&) { return 0.0; });
  panel.series.push_back({.x = std::move(band.x),
                          .y = std::move(band.y),
                          .low = std::move(band.low),
                          .high = std::move(band.high),
                          .colour = kBlue,
                          .width = 0.3});
  panel.series.push_back(
      {.x = std::move(difference.x), .y = std::move(difference.y), .colour = kBlack, .width = kThin});
  return one_panel(std::move(panel));
}

// Points: the difference with the bias, against the mean of both on one zero.
Figure bland_altman_figure(const Comparison& c, const std::string& unit) {
  Panel panel{.title = fmt::format("Bias {:.4g} {}, limits of agreement {:.4g} and {:.4g} {}", c.alignment.bias.value,
                                   unit, c.lower_limit, c.upper_limit, unit),
              .x_label = fmt::format("Mean of both, {}", unit),
              .y_label = fmt::format("moiregauge - reference, {}", unit)};
  Series points{.colour = kBlue, .mark = Mark::kDots, .width = kPoint};
  const std::size_t stride = c.rows.size() / kMaxPointsDrawn + 1;
  for (std::size_t k = 0; k < c.rows.size(); k += stride) {
    points.x.push_back(0.5 * (c.rows[k].measured + c.rows[k].reference));
    points.y.push_back(c.rows[k].difference + c.alignment.bias.value);
  }
  const auto [low, high] = std::minmax_element(points.x.begin(), points.x.end());
  const double rim = 0.03 * (*high - *low);
  const std::vector<double> ends{*low - rim, *high + rim};
  panel.x_range = Range{ends[0], ends[1]};
  for (const double level : {c.lower_limit, c.upper_limit})
    panel.series.push_back(
        {.x = ends, .y = {level, level}, .colour = kVermilion, .mark = Mark::kDashed, .width = kGuide});
  panel.series.push_back(
      {.x = ends, .y = {c.alignment.bias.value, c.alignment.bias.value}, .colour = kVermilion, .width = kGuide});
  panel.series.push_back(std::move(points));
  return one_panel(std::move(panel));
}

}  // namespace

std::vector<NamedFigure> comparison_figures(const Comparison& comparison, const std::string& channel,
                                            const std::string& unit) {
  return {{"series", series_figure(comparison, channel, unit)},
          {"difference", difference_figure(comparison, unit)},
          {"bland-altman", bland_altman_figure(comparison, unit)}};
}

}  // namespace moiregauge::internal::figure
