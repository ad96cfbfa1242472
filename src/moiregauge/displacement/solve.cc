// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/layout.h"
#include "moiregauge/displacement/lens_evidence.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

using BoardExtent = Extent<frame::Board>;

// Below this share of the reference frame's modulation the fringe is smeared, not merely dimmer.
constexpr double kBlurredModulation = 0.5;
// More clipped pixels than this in a window bend the fringe's shape.
constexpr double kClippedShare = 0.05;
// A model error of this many times the noise is no longer an uncertainty one can state.
constexpr double kUntrusted = 10.0;
// No print, lens or pixel is so good that noise alone could be below this share of a pitch (0.5 um of 10 mm).
constexpr double kNoiseFloorPitches = 5e-5;
// A circle alone, without a grating to refine it: how well a printed disc's outline is its centre's, on real prints.
constexpr double kPrintedCirclePx = 0.03;
// A reference this far (of its pitch) from where the circles put it may sit in the next lattice line.
constexpr double kOrderLimit = 0.4;
// A target looks larger or smaller than the references by more than this (and five times its noise) only when it stands off
// their plane: 0.26 % is what 1 mm of misplaced references 380 mm apart can do.
constexpr double kOffPlane = 0.005;
constexpr double kStretchNoise = 5.0;
// The camera has moved when the references have, by more than noise and a 1/2000 pitch.
constexpr double kCameraMovedPitches = 0.0005;
constexpr double kCameraMovedNoise = 5.0;

BoardExtent hypot3(BoardExtent a, BoardExtent b, BoardExtent c) {
  return {std::hypot(a.x, b.x, c.x), std::hypot(a.y, b.y, c.y)};
}

// Noise of a patch along the board's axes, mm.
BoardExtent noise_mm(const RasterPlan& plan, const PatchReading& patch) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  const double u0 = plan.pitch_mm / kTurn * (plan.reads_x ? patch.u_phase_rad[0] : 0.0);
  const double u1 = plan.pitch_mm / kTurn * (plan.reads_y ? patch.u_phase_rad[1] : 0.0);
  return {std::hypot(c * u0, s * u1), std::hypot(s * u0, c * u1)};
}

// Noise of every reference as a point of the second homography.
std::vector<BoardExtent> reference_noise(const Reference& reference, const Observation& seen) {
  std::vector<BoardExtent> u;
  for (const CirclePoint& point : reference.circles) {
    const double circle = std::hypot(point.u_px, kPrintedCirclePx) * reference.view.mm_per_px(point.board);
    u.push_back(reference.site.markers[point.marker].grating
                    ? noise_mm(reference.plans[point.marker], seen.markers[point.marker].patch)
                    : BoardExtent{circle, circle});
  }
  return u;
}

// How much larger than the references' prints a target's looks, relative, in the reference frame: what stands off the
// plane looks so. Half the trace of the displacement gradient; nullopt where a region of few pixels cannot tell.
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

// A target off the plane by dz seen by a camera that travels by t moves by dz t / (Z + dz) on the board. dz / Z is how much
// larger it looks; of t only the bound is known that all of the picture's motion there was travel.
BoardExtent parallax_bound(const Reference& reference, const Observation& seen, std::size_t target) {
  const auto larger = looks_larger(reference, target);
  if (!larger) return {};
  const BoardPoint p = reference.site.markers[target].grating->centre;
  const auto moved = reference.view.ideal_from_board.inverse()(seen.stage2(p)) - p;
  return {std::abs(*larger * moved.x), std::abs(*larger * moved.y)};
}

Status status_of_loss(Loss loss) { return loss == Loss::kTooCoarse ? Status::kTooCoarse : Status::kLost; }

Status quality(const RasterPlan& plan, const PatchReading& then, const PatchReading& now) {
  if (is_bent(plan, then, now)) return Status::kPartlyCovered;
  if (now.clipped_share > kClippedShare) return Status::kSaturated;
  for (std::size_t a = 0; a < 2; ++a) {
    if (now.modulation[a] < kBlurredModulation * then.modulation[a]) return Status::kBlurred;
  }
  return Status::kOk;
}

bool is_target(const Reference& reference, std::size_t i) {
  return reference.site.markers[i].role == Role::kTarget && reference.site.markers[i].grating.has_value();
}

Sample zero_sample(const Observation& seen, std::size_t marker) {
  return {seen.frame, seen.time_s, marker, {0.0, 0.0}, {0.0, 0.0}, {}, Status::kOk};
}

// Any reference grating so far from its place that its lattice line is in doubt?
bool order_in_doubt(const Reference& reference, const Observation& seen) {
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    if (!reference.site.markers[i].grating || seen.markers[i].loss != Loss::kNone) continue;
    const auto moved = displacement_between(reference.plans[i], reference.seen.markers[i].patch, seen.markers[i].patch);
    const auto along = raster_from_board(reference.plans[i], moved);
    for (const double d : along) {
      if (std::abs(d) > kOrderLimit * reference.plans[i].pitch_mm) return true;
    }
  }
  return false;
}

bool camera_moved(const Reference& reference, const Observation& seen) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kReference || !reference.site.markers[i].grating) continue;
    const MarkerObservation& now = seen.markers[i];
    if (now.loss != Loss::kNone) return true;  // it left its window: something moved, and the references stand still
    const PatchReading& then = reference.seen.markers[i].patch;
    const BoardExtent moved = displacement_between(reference.plans[i], then, now.patch);
    const BoardExtent u = noise_mm(reference.plans[i], now.patch);
    const double allowed = kCameraMovedPitches * reference.plans[i].pitch_mm;
    if (std::abs(moved.x) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.x) return true;
    if (std::abs(moved.y) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.y) return true;
  }
  return false;
}

}  // namespace

Samples solve_conventional(const Reference& reference, const std::vector<Observation>& observations) {
  Samples samples;
  for (const Observation& seen : observations) {
    const bool moved = !seen.decode_error && camera_moved(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      if (seen.frame == reference.seen.frame) {
        samples.push_back(zero_sample(seen, i));
        continue;
      }
      Sample sample{seen.frame, seen.time_s, i, {}, {}, {}, Status::kLost};
      sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
      const MarkerObservation& now = seen.markers[i];
      const PatchReading& then = reference.seen.markers[i].patch;
      if (seen.decode_error) {
        sample.status = Status::kDecodeError;
      } else if (now.loss != Loss::kNone) {
        sample.status = status_of_loss(now.loss);
      } else {
        sample.displacement = displacement_between(reference.plans[i], then, now.patch);
        sample.budget.noise = noise_mm(reference.plans[i], now.patch);
        sample.budget.reference_frame = noise_mm(reference.plans[i], then);
        sample.u = hypot3(sample.budget.noise, sample.budget.reference_frame, {});
        sample.status = moved ? Status::kCameraMoved : quality(reference.plans[i], then, now.patch);
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

Samples solve_two_stage(const Reference& reference, const std::vector<Observation>& observations) {
  const LensEvidence lens = lens_evidence(reference, observations);
  std::vector<BoardPoint> circles;
  for (const CirclePoint& point : reference.circles) circles.push_back(point.board);
  const std::vector<BoardExtent> then_noise = reference_noise(reference, reference.seen);
  Follower follower(reference);
  Samples samples;
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const auto travel = follower.follow(reference, seen);
    const bool doubtful = seen.references_seen && order_in_doubt(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      if (seen.frame == reference.seen.frame) {
        samples.push_back(zero_sample(seen, i));
        continue;
      }
      Sample sample{seen.frame, seen.time_s, i, {}, {}, {}, Status::kLost};
      sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
      const MarkerObservation& now = seen.markers[i];
      const MarkerObservation& then = reference.seen.markers[i];
      if (seen.decode_error) sample.status = Status::kDecodeError;
      else if (!seen.references_seen) sample.status = Status::kReferenceLost;
      else if (now.loss != Loss::kNone) sample.status = status_of_loss(now.loss);
      else if (doubtful) sample.status = Status::kOrderUnproven;
      else {
        const auto weights = reference_weights(circles, reference.site.markers[i].grating->centre + now.window_shift);
        sample.displacement = travel[i];
        Budget& budget = sample.budget;
        budget.noise = noise_mm(reference.plans[i], now.patch);
        budget.references = through_references(weights, reference_noise(reference, seen));
        budget.reference_frame =
            hypot3(noise_mm(reference.plans[i], then.patch), through_references(weights, then_noise), {});
        const std::vector<BoardExtent> unexplained(circles.size(), {lens.unexplained_mm[n], lens.unexplained_mm[n]});
        const double kappa = std::hypot(lens.kappa_px, lens.u_kappa_px);
        const BoardExtent& e = lens.sensitivity[n][i];
        budget.model = hypot3({kappa * e.x, kappa * e.y}, through_references(weights, unexplained),
                              parallax_bound(reference, seen, i));
        const BoardExtent noise = hypot3(budget.noise, budget.references, budget.reference_frame);
        sample.u = hypot3(noise, budget.model, {});
        const double floor = kNoiseFloorPitches * reference.plans[i].pitch_mm;
        const bool beyond = budget.model.x > kUntrusted * std::max(noise.x, floor) ||
                            budget.model.y > kUntrusted * std::max(noise.y, floor);
        sample.status = beyond ? Status::kUntrusted : quality(reference.plans[i], then.patch, now.patch);
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

}  // namespace moiregauge
