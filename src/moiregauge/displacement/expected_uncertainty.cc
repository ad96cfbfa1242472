// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/expected_uncertainty.h"

#include <cmath>

#include "moiregauge/displacement/layout.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/phase/sampling_moire.h"

namespace moiregauge {
namespace {

// The reading with the phase noise no estimator can beat: its region grown to the whole print.
PatchReading at_the_bound(const Reference& reference, std::size_t i) {
  PatchReading patch = reference.seen.markers[i].patch;
  const Grating& print = *reference.site.markers[i].grating;
  const double mm_per_px = reference.view.mm_per_px(print.centre);
  const double pixels = print.width_mm * print.height_mm / (mm_per_px * mm_per_px);
  for (std::size_t a = 0; a < 2; ++a)
    patch.u_phase_rad[a] = phase_bound(patch.noise_sigma, patch.modulation[a], pixels);
  return patch;
}

// An axis of the board along which the print shows nothing: lines that lie along it.
BoardExtent shown(const RasterPlan& plan, BoardExtent u) {
  const BoardExtent seen = displacement_between(plan, PatchReading{}, PatchReading{});
  return {std::isnan(seen.x) ? kNotMeasured : u.x, std::isnan(seen.y) ? kNotMeasured : u.y};
}

}  // namespace

std::vector<ExpectedUncertainty> expected_uncertainties(const Reference& reference) {
  std::vector<BoardPoint> places;
  std::vector<BoardExtent> noise = reference_noise(reference, reference.seen), bound = noise;
  for (std::size_t k = 0; k < reference.circles.size(); ++k) {
    const std::size_t i = reference.circles[k].marker;
    places.push_back(reference.circles[k].board);
    if (reference.site.markers[i].grating) bound[k] = noise_mm(reference.plans[i], at_the_bound(reference, i));
  }
  std::vector<ExpectedUncertainty> out;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (!is_target(reference, i)) continue;
    const BoardExtent none{kNotMeasured, kNotMeasured};
    if (reference.seen.markers[i].loss != Loss::kNone) {
      out.push_back({i, none, none});
      continue;
    }
    const RasterPlan& plan = reference.plans[i];
    const auto weights = reference_weights(places, reference.site.markers[i].grating->centre);
    const auto since_reference_frame = [&](const PatchReading& patch, const std::vector<BoardExtent>& references) {
      return shown(plan, std::sqrt(2.0) * hypot3(noise_mm(plan, patch), through_references(weights, references), {}));
    };
    out.push_back({i, since_reference_frame(reference.seen.markers[i].patch, noise),
                   since_reference_frame(at_the_bound(reference, i), bound)});
  }
  return out;
}

}  // namespace moiregauge
