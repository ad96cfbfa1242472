// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/codec.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

void include(PixelRectangle& at, ImagePoint p) {
  at.x0 = std::min(at.x0, p.x), at.y0 = std::min(at.y0, p.y);
  at.x1 = std::max(at.x1, p.x), at.y1 = std::max(at.y1, p.y);
}

}  // namespace

PixelRectangle rectangle_round(const Marker& marker, Extent<frame::Board> shift, const View& view) {
  PixelRectangle out;
  const BoardPoint centre = (marker.grating ? marker.grating->centre : marker.circle->centre) + shift;
  const double across = marker.grating ? marker.grating->width_mm : marker.circle->diameter_mm;
  const double up = marker.grating ? marker.grating->height_mm : marker.circle->diameter_mm;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) include(out, view(centre + Extent<frame::Board>{x * across, y * up}));
  }
  return out;
}

void note_quantisers(const QuantiserMap& quantiser, const Site& site, const Camera& lens, Observation& seen) {
  const View view{seen.stage2, lens};
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    MarkerObservation& marker = seen.markers[i];
    marker.quantiser = quantiser.whole;
    if (!seen.references_seen || i >= site.markers.size() || marker.loss != Loss::kNone) continue;
    if (!site.markers[i].grating && !site.markers[i].circle) continue;
    const PixelRectangle at = rectangle_round(site.markers[i], marker.window_shift, view);
    marker.quantiser = quantiser.within(at.x0, at.y0, at.x1, at.y1);
  }
}

double rounding_of(const QuantiserMap& quantiser, const Reference& reference, const Observation& last) {
  if (quantiser.whole.is_lossless()) return 0.0;
  Observation there;
  there.references_seen = last.references_seen;
  there.stage2 = last.stage2;
  there.markers = last.markers;
  note_quantisers(quantiser, reference.site, reference.lens, there);
  return rounding_of(reference, there);
}

double rounding_of(const Reference& reference, const Observation& seen) {
  double step = 0.0;
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    step = std::max(step, reference.step_of(i, seen.markers[i].quantiser));
  return rounding_of_step(step);
}

bool is_lossy(const Observation& seen) {
  return std::ranges::any_of(seen.markers, [](const MarkerObservation& m) { return !m.quantiser.is_lossless(); });
}

bool is_lossy(const Observations& observations) {
  for (const Observation& seen : observations) {
    if (is_lossy(seen)) return true;
  }
  return false;
}

std::optional<std::string> codec_note(const Measurement& measurement) {
  if (!measurement.reference || !is_lossy(measurement.observations)) return std::nullopt;
  std::vector<double> steps;
  bool known = true, predicted = false;
  for (const Observation& seen : measurement.observations) {
    for (const MarkerObservation& marker : seen.markers) {
      known = known && !std::isnan(marker.quantiser.step);
      predicted = predicted || marker.quantiser.predicted;
      if (!std::isnan(marker.quantiser.step)) steps.push_back(marker.quantiser.step);
    }
  }
  double u_mm = 0.0;
  for (const TargetSummary& target : measurement.targets) {
    for (const double u : {target.budget.codec.x, target.budget.codec.y}) u_mm = std::fmax(u_mm, u);
  }
  std::string how = "unknown quantiser, a typical value is assumed";
  if (known) {  // 0.9 quantile: skipped blocks may report a smaller step than the one that applied
    const auto coarse = steps.begin() + static_cast<long>(0.9 * static_cast<double>(steps.size() - 1));
    std::nth_element(steps.begin(), coarse, steps.end());
    how = fmt::format("quantisation step {:.0f} grey levels", *coarse);
  }
  // With a known quantiser u contains all of the codec's error.
  const char* level = known ? "note: " : "";
  if (!predicted)
    return fmt::format("{}compression adds about {:.4f} mm to u ({}, {}). Record raw or lossless to avoid this", level,
                       u_mm, measurement.input.codec, how);
  return fmt::format(
      "{}movements below about {:.3f} mm may be invisible: the video is compressed ({}; {}). Record at the highest bit "
      "rate, intra-only or raw",
      level, 2.0 * u_mm, measurement.input.codec, how);
}

}  // namespace moiregauge::internal
