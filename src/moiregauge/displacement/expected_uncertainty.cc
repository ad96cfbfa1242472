// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/expected_uncertainty.h"

#include <cmath>

#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/planning/codec_error.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {
namespace {

// Returns the reading with the Cramer-Rao bound of the phase, for all pixels of the grating.
PatchReading at_the_bound(const Reference& reference, std::size_t i) {
  PatchReading patch = reference.seen.markers[i].patch;
  const Grating& print = *reference.site.markers[i].grating;
  const double mm_per_px = reference.view.mm_per_px(print.centre);
  const double pixels = print.width_mm * print.height_mm / (mm_per_px * mm_per_px);
  for (std::size_t a = 0; a < 2; ++a)
    patch.u_phase_rad[a] = phase_bound(patch.noise_sigma, patch.modulation[a], pixels);
  return patch;
}

// Returns u with NaN for a board axis that the grating does not show (lines along it).
BoardExtent shown(const RasterPlan& plan, BoardExtent u) {
  const BoardExtent seen = displacement_between(plan, PatchReading{}, PatchReading{});
  return {std::isnan(seen.x) ? kNotMeasured : u.x, std::isnan(seen.y) ? kNotMeasured : u.y};
}

// Codec's error of target and references in a later frame and the reference frame, as in solve_two_stage.cc.
class ExpectedCodec {
 public:
  ExpectedCodec(const Reference& reference, std::span<const Quantiser> later) : reference_(reference), later_(later) {}

  [[nodiscard]] BoardExtent of_target(std::size_t target, std::span<const Matrix2> weights) const {
    std::vector<BoardExtent> now, then;
    for (const CirclePoint& point : reference_.circles) {
      now.push_back(of_marker(point.marker, later(point.marker), Lag::kShared));
      then.push_back(of_marker(point.marker, first(point.marker), Lag::kShared));
    }
    const Lag lag_then = reference_.seen.frame == 0 ? Lag::kShared : Lag::kOwn;
    return hypot3(hypot3(through_references(weights, now), through_references(weights, then), {}),
                  of_marker(target, later(target), Lag::kOwn), of_marker(target, first(target), lag_then));
  }

 private:
  [[nodiscard]] Quantiser first(std::size_t marker) const {
    const Quantiser& quantiser = reference_.seen.markers[marker].quantiser;
    return {reference_.step_of(marker, quantiser), quantiser.predicted};
  }
  [[nodiscard]] Quantiser later(std::size_t marker) const {
    if (marker >= later_.size()) return first(marker);
    return {reference_.step_of(marker, later_[marker]), later_[marker].predicted};
  }
  [[nodiscard]] BoardExtent of_marker(std::size_t marker, const Quantiser& quantiser, Lag lag) const {
    return codec_mm(reference_, marker, reference_.seen.markers[marker].patch, quantiser, lag);
  }

  const Reference& reference_;
  std::span<const Quantiser> later_;
};

}  // namespace

std::vector<ExpectedUncertainty> expected_uncertainties(const Reference& reference, std::span<const Quantiser> later) {
  std::vector<BoardPoint> places;
  std::vector<BoardExtent> noise = reference_noise(reference, reference.seen), bound = noise;
  for (std::size_t k = 0; k < reference.circles.size(); ++k) {
    const std::size_t i = reference.circles[k].marker;
    places.push_back(reference.circles[k].board);
    if (reference.site.markers[i].grating) bound[k] = noise_mm(reference.plans[i], at_the_bound(reference, i));
  }
  const ExpectedCodec codec(reference, later);
  std::vector<ExpectedUncertainty> out;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (!is_target(reference, i)) continue;
    const BoardExtent none{kNotMeasured, kNotMeasured};
    if (reference.seen.markers[i].loss != Loss::kNone) {
      out.push_back({i, none, none, none});
      continue;
    }
    const RasterPlan& plan = reference.plans[i];
    const auto weights = reference_weights(places, reference.site.markers[i].grating->centre);
    const auto since_reference_frame = [&](const PatchReading& patch, const std::vector<BoardExtent>& references) {
      return shown(plan, std::sqrt(2.0) * hypot3(noise_mm(plan, patch), through_references(weights, references), {}));
    };
    const BoardExtent lossy = shown(plan, codec.of_target(i, weights));
    out.push_back({i, hypot3(since_reference_frame(reference.seen.markers[i].patch, noise), lossy, {}), lossy,
                   since_reference_frame(at_the_bound(reference, i), bound)});
  }
  return out;
}

}  // namespace moiregauge::internal
