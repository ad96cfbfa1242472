// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/lens_evidence.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/reading_noise.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/planning/codec_error.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {
namespace {

// Ratio of model error to noise above which a row is `untrusted`. Chosen.
constexpr double kUntrusted = 10.0;
// Least noise of this test, pitches: 0.5 um for 10 mm. No real grating, lens or sensor is better. Chosen.
constexpr double kNoiseFloorPitches = 5e-5;
// Relative difference of apparent size, beyond five times its noise, that shows a target off the plane. References 380
// mm apart with 1 mm of position error cause 0.26 %.
constexpr double kOffPlane = 0.005;
constexpr double kStretchNoise = 5.0;

// Returns the relative excess of a target's apparent size over that of the references in the reference frame. A target
// off the plane shows it. It is half the trace of the displacement gradient.
// Fails (nothing): the excess is not significant.
std::optional<double> looks_larger(const Reference& reference, std::size_t target) {
  const auto stretch = [&](std::size_t i) {
    const auto& g = reference.seen.markers[i].patch.gradient;
    return 0.5 * (g[0][0] + g[1][1]);
  };
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kReference || !reference.site.markers[i].grating) continue;
    sum += stretch(i);
    ++count;
  }
  const double larger = stretch(target) - (count > 0 ? sum / count : 0.0);
  const double noise = kStretchNoise * reference.seen.markers[target].patch.u_gradient;
  if (!(std::abs(larger) > kOffPlane + noise)) return std::nullopt;
  return larger;
}

// Returns an upper limit of the parallax, mm. A target at dz off the plane moves by dz t / (Z + dz) on the board if the
// camera travels by t. The excess of apparent size gives dz / Z. The whole motion of the image there is the limit of t.
BoardExtent parallax_bound(const Reference& reference, const Observation& seen, std::size_t target) {
  const auto larger = looks_larger(reference, target);
  if (!larger) return {};
  const BoardPoint p = reference.site.markers[target].grating->centre;
  const auto moved = reference.view.ideal_from_board.inverse()(seen.stage2(p)) - p;
  return {std::abs(*larger * moved.x), std::abs(*larger * moved.y)};
}

// Quantities of the whole run that a sample needs.
struct RunEvidence {
  const Reference& reference;
  LensEvidence lens;
  std::vector<BoardPoint> circles;
  std::vector<BoardExtent> then_noise;  // noise of the references in the reference frame
  const CodecHistory& codec;
};

// Returns the codec's error of target and references, in this frame and the reference frame. The u of a circle without
// a grating already includes it.
BoardExtent codec_part(const RunEvidence& run, std::size_t n, const Observation& seen, std::size_t target,
                       std::span<const Matrix2> weights) {
  if (!run.codec.is_lossy()) return {};
  const Reference& reference = run.reference;
  std::vector<BoardExtent> now, then;
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    now.push_back(codec_mm(reference, i, seen.markers[i].patch, run.codec.at(n, i), Lag::kShared));
    then.push_back(
        codec_mm(reference, i, reference.seen.markers[i].patch, run.codec.in_reference_frame(i), Lag::kShared));
  }
  const BoardExtent references = hypot3(through_references(weights, now), through_references(weights, then), {});
  return hypot3(references, codec_mm(reference, target, seen.markers[target].patch, run.codec.at(n, target), Lag::kOwn),
                codec_mm(reference, target, reference.seen.markers[target].patch, run.codec.in_reference_frame(target),
                         run.codec.lag_in_reference_frame(target)));
}

void measure_against_references(const RunEvidence& run, const Observation& seen, std::size_t n, BoardExtent travel,
                                Sample& sample) {
  const Reference& reference = run.reference;
  const std::size_t i = sample.marker;
  const RasterPlan& plan = reference.plans[i];
  const MarkerObservation& now = seen.markers[i];
  const PatchReading& then = reference.seen.markers[i].patch;
  const auto weights = reference_weights(run.circles, reference.site.markers[i].grating->centre + now.window_shift);
  sample.displacement = travel;
  Budget& budget = sample.budget;
  budget.noise = noise_mm(plan, now.patch);
  budget.references = through_references(weights, reference_noise(reference, seen));
  budget.reference_frame = hypot3(noise_mm(plan, then), through_references(weights, run.then_noise), {});
  const double left = run.lens.unexplained_mm[n];
  const std::vector<BoardExtent> unexplained(run.circles.size(), {left, left});
  const double kappa = std::hypot(run.lens.kappa_px, run.lens.u_kappa_px);
  const BoardExtent& e = run.lens.sensitivity[n][i];
  budget.model =
      hypot3({kappa * e.x, kappa * e.y}, through_references(weights, unexplained), parallax_bound(reference, seen, i));
  budget.codec = codec_part(run, n, seen, i, weights);
  const BoardExtent noise = hypot3(hypot3(budget.noise, budget.references, budget.reference_frame), budget.codec, {});
  add_movement_along_lines(*reference.site.markers[i].grating, reference.site.known_to.rotation_rad, sample);
  sample.u = hypot3(noise, budget.model, budget.axis);
  const double floor = kNoiseFloorPitches * plan.pitch_mm;
  const bool beyond =
      budget.model.x > kUntrusted * std::max(noise.x, floor) || budget.model.y > kUntrusted * std::max(noise.y, floor);
  sample.status = beyond ? Status::kUntrusted : quality(plan, then, now.patch);
  withhold_unshown_axes(sample);
}

Solution two_stage_in_noise(const Reference& reference, const Observations& observations, const CodecHistory& codec,
                            double excess) {
  RunEvidence run{
      reference, lens_evidence(reference, observations, excess), {}, reference_noise(reference, reference.seen), codec};
  for (const CirclePoint& point : reference.circles) run.circles.push_back(point.board);
  Follower follower(reference);
  Solution solution;
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation seen = with_noise(observations[n], excess);
    const auto travel = follower.follow(reference, seen);
    const bool doubtful = seen.references_seen && order_in_doubt(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      Sample sample = initial_sample(reference, seen, i);
      if (seen.frame != reference.seen.frame) {
        if (seen.decode_error)
          sample.status = Status::kDecodeError;
        else if (!seen.references_seen)
          sample.status = Status::kReferenceLost;
        else if (seen.markers[i].loss != Loss::kNone)
          sample.status = status_of_loss(seen.markers[i].loss);
        else if (doubtful || seen.markers[i].order == Order::kContradicted)
          sample.status = Status::kOrderUnproven;
        else
          measure_against_references(run, seen, n, travel[i], sample);
      }
      solution.samples.push_back(sample);
    }
  }
  doubt_after_leaps(reference.site, solution.samples);
  return solution;
}

}  // namespace

Solution solve_two_stage(const Reference& reference, const Observations& observations, const SolveOptions&) {
  return solve_in_own_noise(reference, observations, two_stage_in_noise);
}

}  // namespace moiregauge::internal
