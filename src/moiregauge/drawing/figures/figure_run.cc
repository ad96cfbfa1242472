// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/figures/figure_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "moiregauge/drawing/figures/figure_overlay.h"
#include "moiregauge/drawing/plots/plot.h"

namespace moiregauge::internal::figure {
namespace {

constexpr double kColumn_mm = 85.0, kLetters = 8.0;
constexpr double kZoom = kLetters / kTextSize;
constexpr double kWidth = kColumn_mm * 72.0 / 25.4;
constexpr double kInside = kWidth / kZoom;  // in layout units of the panels
constexpr double kRunMargin = 3.0, kRunHeight = 104.0;
constexpr double kCoverage = 2.0;          // coverage factor k of U
constexpr std::size_t kTargetsAPanel = 3;  // one line of the legend has no space for more names
constexpr double kNotOkRadius = 1.3;
constexpr double kLine = 0.8;

using ExtentAxis = double Extent<frame::Board>::*;

Figure column_of(std::vector<Panel> panels) {
  const double height = kZoom * (2 * kRunMargin + static_cast<double>(panels.size()) * kRunHeight);
  return {kWidth, height,
          [panels = std::move(panels)](Canvas& canvas) {
            for (std::size_t i = 0; i < panels.size(); ++i) {
              const double y = kRunMargin + static_cast<double>(i) * kRunHeight;
              draw_panel(canvas, {kRunMargin, y, kInside - 2 * kRunMargin, kRunHeight}, panels[i]);
            }
          },
          kZoom};
}

std::string letter(std::size_t place) { return fmt::format("({})", static_cast<char>('a' + place % 26)); }

bool has_times(const RunFound& found) {
  return std::any_of(found.samples.begin(), found.samples.end(),
                     [](const Sample& s) { return std::isfinite(s.time_s); });
}

std::vector<std::size_t> targets_of(const RunFound& found) {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < found.reference.site.markers.size(); ++i)
    if (found.reference.site.markers[i].role == Role::kTarget) targets.push_back(i);
  return targets;
}

// Returns the values of the rows that are `ok`, or of the others; NaN elsewhere.
Curve curve_of(const RunFound& found, std::size_t marker, ExtentAxis axis, bool is_ok) {
  const bool by_time = has_times(found);
  Curve curve;
  for (const Sample& s : found.samples) {
    if (s.marker != marker) continue;
    const double value = (s.status == Status::kOk) == is_ok ? s.displacement.*axis : kNotMeasured;
    curve.x.push_back(by_time ? s.time_s : static_cast<double>(s.frame));
    curve.y.push_back(value);
    curve.low.push_back(value - kCoverage * s.u.*axis);
    curve.high.push_back(value + kCoverage * s.u.*axis);
  }
  return thinned(curve);
}

// Returns the shade of the axis colour for the i-th target of a panel: as it is, lighter, darker.
Colour shade(Colour colour, std::size_t i) {
  constexpr std::array kTowards{0.0, 1.0, 0.0}, kShare{0.0, 0.5, 0.55};
  const double towards = kTowards[i % kTowards.size()], share = kShare[i % kShare.size()];
  const auto mixed = [&](double part) { return part + share * (towards - part); };
  return {mixed(colour.r), mixed(colour.g), mixed(colour.b)};
}

bool is_measured(const Curve& curve) {
  return std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return std::isfinite(y); });
}

double rms_u(const RunFound& found, std::size_t marker, ExtentAxis axis) {
  double sum = 0.0, count = 0.0;
  for (const Sample& s : found.samples) {
    if (s.marker != marker || !(s.u.*axis > 0.0)) continue;
    sum += s.u.*axis * s.u.*axis;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : kNotMeasured;
}

// Returns the curves of up to three targets along one axis.
Panel targets_panel(const RunFound& found, const std::vector<std::size_t>& targets, const char* name, ExtentAxis axis,
                    Colour colour) {
  Panel panel{.x_label = has_times(found) ? "Time, s" : "Frame", .y_label = fmt::format("{}, mm", name)};
  const auto& markers = found.reference.site.markers;
  std::vector<Series> not_ok;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (Curve doubted = curve_of(found, targets[i], axis, false); is_measured(doubted))
      not_ok.push_back({.name = not_ok.empty() ? "not ok" : "",
                        .x = std::move(doubted.x),
                        .y = std::move(doubted.y),
                        .colour = kNotOkInk,
                        .mark = Mark::kOpenDots,
                        .width = kNotOkRadius});
    Curve curve = curve_of(found, targets[i], axis, true);
    if (!is_measured(curve)) continue;
    panel.series.push_back({.name = markers[targets[i]].name,
                            .x = std::move(curve.x),
                            .y = std::move(curve.y),
                            .low = std::move(curve.low),
                            .high = std::move(curve.high),
                            .colour = shade(colour, i),
                            .width = kLine});
  }
  if (targets.size() == 1 && !panel.series.empty())
    panel.title = fmt::format("{}, band U = {:.2g} mm (k = 2)", markers[targets[0]].name,
                              kCoverage * rms_u(found, targets[0], axis));
  for (Series& series : not_ok) panel.series.push_back(std::move(series));
  return panel;
}

std::optional<Figure> displacement_figure(const RunFound& found) {
  const auto targets = targets_of(found);
  std::vector<Panel> panels;
  for (std::size_t first = 0; first < targets.size(); first += kTargetsAPanel) {
    const auto begin = targets.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<std::size_t> group(
        begin, begin + static_cast<std::ptrdiff_t>(std::min(kTargetsAPanel, targets.size() - first)));
    for (const auto& [name, axis, colour] : {std::tuple{"dx", &Extent<frame::Board>::x, kAxisXInk},
                                             std::tuple{"dy", &Extent<frame::Board>::y, kAxisYInk}}) {
      Panel panel = targets_panel(found, group, name, axis, colour);
      if (panel.series.empty()) continue;  // a grating of lines shows one axis only
      panel.letter = letter(panels.size());
      panels.push_back(std::move(panel));
    }
  }
  if (panels.empty()) return std::nullopt;
  return column_of(std::move(panels));
}

// Labels the peaks. A peak next to a labelled one has no label.
void note_peaks(Panel& panel, const AxisSpectrum& spectrum) {
  const auto& f = spectrum.spectrum.frequency_hz;
  const double apart = f.empty() ? 0.0 : 0.2 * f.back();
  for (const Peak& peak : spectrum.peaks) {
    const bool is_named = std::any_of(panel.notes.begin(), panel.notes.end(),
                                      [&](const Note& note) { return std::abs(note.x - peak.frequency_hz) < apart; });
    const auto at = std::lower_bound(f.begin(), f.end(), peak.frequency_hz) - f.begin();
    if (is_named || f.empty()) continue;
    double top = 0.0;  // the PSD at this peak, without its neighbours
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, at - 2); i < std::min<std::ptrdiff_t>(at + 3, std::ssize(f));
         ++i)
      top = std::max(top, spectrum.spectrum.psd[static_cast<std::size_t>(i)]);
    panel.notes.push_back({peak.frequency_hz, top, fmt::format("{:.3g} Hz", peak.frequency_hz)});
  }
}

Panel spectrum_panel(const RunFound& found, std::size_t target, std::string& refusal) {
  Panel panel{.title = found.reference.site.markers[target].name,
              .x_label = "Frequency, Hz",
              .y_label = "PSD, mm²/Hz",
              .y_scale = Scale::kLog};
  Range seen{1e300, 0.0};
  for (const auto& [name, axis, colour] :
       {std::tuple{"dx", &Extent<frame::Board>::x, kAxisXInk}, std::tuple{"dy", &Extent<frame::Board>::y, kAxisYInk}}) {
    const AxisSpectrum spectrum = spectrum_of(series_of(found.samples, target, axis));
    if (!spectrum.refusal.empty()) {
      refusal = spectrum.refusal;
      continue;
    }
    const auto& s = spectrum.spectrum;
    panel.series.push_back({.name = name,
                            .x = {s.frequency_hz.begin() + 1, s.frequency_hz.end()},
                            .y = {s.psd.begin() + 1, s.psd.end()},
                            .colour = colour,
                            .width = kLine});
    for (std::size_t i = 1; i < s.psd.size(); ++i)
      if (s.psd[i] > 0.0) seen = {std::min(seen.low, s.psd[i]), std::max(seen.high, s.psd[i])};
    panel.x_range = Range{0.0, s.frequency_hz.back()};
    note_peaks(panel, spectrum);
  }
  constexpr double kRoomForNotes = 8.0;
  if (seen.high > 0.0) panel.y_range = Range{0.7 * seen.low, kRoomForNotes * seen.high};
  return panel;
}

std::optional<Figure> spectrum_figure(const RunFound& found, std::string& refusal) {
  std::vector<Panel> panels;
  for (const std::size_t target : targets_of(found)) {
    Panel panel = spectrum_panel(found, target, refusal);
    if (panel.series.empty()) continue;
    panel.letter = letter(panels.size());
    panels.push_back(std::move(panel));
  }
  if (panels.empty()) return std::nullopt;
  return column_of(std::move(panels));
}

// Camera curves have shades of one colour; the second is dashed.
Series motion_series(const char* name, const std::vector<double>& x, const std::vector<double>& y, std::size_t place) {
  constexpr std::array kShades{0.0, 0.25, 0.6};
  Curve curve = thinned({x, y, y, y});
  const auto lighter = [&](double part) { return part + kShades[place] * (1.0 - part); };
  return {.name = name,
          .x = std::move(curve.x),
          .y = std::move(curve.y),
          .colour = {lighter(kCameraInk.r), lighter(kCameraInk.g), lighter(kCameraInk.b)},
          .mark = place == 1 ? Mark::kDashed : Mark::kLine,
          .width = kLine};
}

Figure camera_figure(const RunFound& found) {
  const CameraMotion motion =
      camera_motion(found.reference, found.observations, known_camera(found.reference, found.scene));
  const bool by_time = has_times(found);
  const std::vector<double> x = by_time ? motion.time_s : std::vector<double>(motion.frame.begin(), motion.frame.end());
  const std::string x_label = by_time ? "Time, s" : "Frame";
  std::vector<Panel> panels;
  panels.push_back({.letter = "(a)", .title = "Image", .x_label = x_label, .y_label = "Shift, px"});
  panels.back().series = {motion_series("right", x, motion.shift_x_px, 0),
                          motion_series("down", x, motion.shift_y_px, 1)};
  if (!motion.turn_x_deg.empty()) {
    panels.push_back({.letter = "(b)", .title = "Camera", .x_label = x_label, .y_label = "Rotation, °"});
    panels.back().series = {motion_series("about x", x, motion.turn_x_deg, 0),
                            motion_series("y", x, motion.turn_y_deg, 1), motion_series("z", x, motion.turn_z_deg, 2)};
  }
  return column_of(std::move(panels));
}

}  // namespace

Curve thinned(const Curve& curve, std::size_t most) {
  const std::size_t count = curve.x.size(), bins = most / 2;
  if (count <= most) return curve;
  Curve out;
  const auto put = [&](std::size_t i) {
    out.x.push_back(curve.x[i]);
    out.y.push_back(curve.y[i]);
    out.low.push_back(curve.low[i]);
    out.high.push_back(curve.high[i]);
  };
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t first = bin * count / bins, end = (bin + 1) * count / bins;
    std::size_t lowest = end, highest = end, gap = end;
    for (std::size_t i = first; i < end; ++i) {
      if (!std::isfinite(curve.y[i])) {
        gap = i;
        continue;
      }
      if (lowest == end || curve.y[i] < curve.y[lowest]) lowest = i;
      if (highest == end || curve.y[i] > curve.y[highest]) highest = i;
    }
    // A gap in a bin ends the line there, so it stays visible.
    if (lowest != end) put(std::min(lowest, highest));
    if (lowest != end && lowest != highest) put(std::max(lowest, highest));
    if (gap != end) put(gap);
  }
  return out;
}

RunFigures run_figures(const RunFound& found) {
  RunFigures out;
  if (auto figure = displacement_figure(found))
    out.figures.push_back({"displacement", *std::move(figure)});
  else
    out.excluded.emplace_back("displacement (no row has a value)");
  std::string refusal;
  if (auto figure = spectrum_figure(found, refusal))
    out.figures.push_back({"spectrum", *std::move(figure)});
  else
    out.excluded.push_back("spectrum (" + refusal + ")");
  out.figures.push_back({"camera", camera_figure(found)});
  if (found.picture.width > 0)
    out.figures.push_back({"overlay", overlay_figure(found.reference, found.picture, kWidth, kZoom)});
  return out;
}

}  // namespace moiregauge::internal::figure
