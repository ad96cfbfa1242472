// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/reading_noise.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {
namespace {

// Displacement of a reference that shows camera motion: 1/2000 pitch, and 5 u of noise. Chosen.
constexpr double kCameraMovedPitches = 0.0005;
constexpr double kCameraMovedNoise = 5.0;

bool camera_moved(const Reference& reference, const Observation& seen) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kReference || !reference.site.markers[i].grating) continue;
    const MarkerObservation& now = seen.markers[i];
    if (now.loss != Loss::kNone) return true;  // it left its window, and references do not move
    const PatchReading& then = reference.seen.markers[i].patch;
    const BoardExtent moved = displacement_between(reference.plans[i], then, now.patch);
    const BoardExtent u = noise_mm(reference.plans[i], now.patch);
    const double allowed = kCameraMovedPitches * reference.plans[i].pitch_mm;
    if (std::abs(moved.x) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.x) return true;
    if (std::abs(moved.y) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.y) return true;
  }
  return false;
}

using RasterWay = std::array<double, 2>;  // mm or pitches along the raster's axes

// Standard uncertainty of the phase per missing share of the grating, rad. Instead of the grating (mean m, amplitude a)
// there is blank paper of level p. It changes the phase by 2 (p - m) / a sin(...) + sin(...), both of unknown phase. A
// binary grating has (p - m) / a = pi / 4.
const double kPhasePerMissing = std::sqrt((0.25 * kPi * kPi + 1.0) / 2.0);

// Returns the standard uncertainty of a displacement along one raster axis, from the part of the fixed window that the
// grating has left, mm. Model: beyond the clearance, n raster pixels at the edge of the window show blank paper. The
// weights of one averaged pixel form a triangle of half width T. At the edge of the averaged region (R pixels),
// n^2 / (2 T^2) of it is missing, and less further inside. The missing share is the mean over the region.
double window_error_mm(const RasterPlan& plan, double along_mm) {
  const auto cube = [](double v) { return v * v * v; };
  const double n = std::max(0.0, (std::abs(along_mm) - plan.clearance_mm) / plan.step_mm);
  const double period = plan.sampling_pitch_px, region = plan.region_px;
  const double missing = (cube(n) - cube(std::max(0.0, n - region))) / (6.0 * period * period * region);
  return kPhasePerMissing * std::min(1.0, missing) * plan.pitch_mm / kTwoPi;
}

// Adds this part to the budget.
void add_window_error(const RasterPlan& plan, const RasterWay& along, Sample& sample) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  const double u0 = window_error_mm(plan, along[0]), u1 = window_error_mm(plan, along[1]);
  sample.budget.model = {std::hypot(c * u0, s * u1), std::hypot(s * u0, c * u1)};
}

// Unwraps the phase of one target over time: every reading gets the fringe order nearest to the last one. A step of
// more than a quarter pitch leaves the order open from there on, because the target may also have moved the other way.
class UnwrappedPhase {
 public:
  UnwrappedPhase(const Reference& reference, std::size_t target)
      : plan_(reference.plans[target]),
        marker_(reference.site.markers[target]),
        u_rotation_rad_(reference.site.known_to.rotation_rad) {}
  void follow(Sample& sample) {
    // If the camera moves, the target's own motion is unknown. As published, it is read within half a pitch.
    if (!has_numbers(sample.status) || sample.status == Status::kCameraMoved) return;
    const auto wrapped = raster_from_board(plan_, {or_zero(sample.displacement.x), or_zero(sample.displacement.y)});
    const auto whole = whole_pitches(wrapped, last_);
    bool is_open = false;
    RasterWay along{};
    for (std::size_t k = 0; k < along.size(); ++k) {
      along[k] = wrapped[k] + whole[k] * plan_.pitch_mm;
      is_open = is_open || std::abs(along[k] - last_[k]) > kSureOfOrder * plan_.pitch_mm;
    }
    // An occlusion may cause any phase. Alone it neither opens the order for good nor settles it.
    if (sample.status == Status::kPartlyCovered) {
      if (!is_open) last_ = along;
    } else {
      is_open_ = is_open_ || is_open || whole != whole_pitches(wrapped, last_whole_print_);
      last_ = last_whole_print_ = along;
    }
    sample.displacement =
        sample.displacement + board_from_raster(plan_, whole[0] * plan_.pitch_mm, whole[1] * plan_.pitch_mm);
    add_window_error(plan_, along, sample);
    add_movement_along_lines(*marker_.grating, u_rotation_rad_, sample);
    sample.u = hypot3(sample.u, sample.budget.model, sample.budget.axis);
    if (!is_open && !is_open_) return;
    sample.status = Status::kOrderUnproven;
    sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
  }

 private:
  // Returns the fringe orders that bring a wrapped reading nearest to `last`.
  [[nodiscard]] RasterWay whole_pitches(const RasterWay& wrapped, const RasterWay& last) const {
    return {std::round((last[0] - wrapped[0]) / plan_.pitch_mm), std::round((last[1] - wrapped[1]) / plan_.pitch_mm)};
  }

  const RasterPlan& plan_;
  const Marker& marker_;
  double u_rotation_rad_;
  RasterWay last_{};              // mm
  RasterWay last_whole_print_{};  // mm: of the last reading without an occlusion
  bool is_open_ = false;
};

// Unwraps one target in both directions from the reference frame, where it is zero.
void follow_orders(const Reference& reference, std::size_t target, Samples& samples) {
  std::vector<Sample*> before, after;
  for (Sample& sample : samples) {
    if (sample.marker == target && sample.frame != reference.seen.frame)
      (sample.frame < reference.seen.frame ? before : after).push_back(&sample);
  }
  std::reverse(before.begin(), before.end());
  for (const auto& way : {before, after}) {
    UnwrappedPhase phase(reference, target);
    for (Sample* sample : way) phase.follow(*sample);
  }
}

void measure_phase(const Reference& reference, const Observation& seen, const CodecHistory& codec, std::size_t n,
                   Sample& sample) {
  const RasterPlan& plan = reference.plans[sample.marker];
  const PatchReading& then = reference.seen.markers[sample.marker].patch;
  const PatchReading& now = seen.markers[sample.marker].patch;
  sample.displacement = displacement_between(plan, then, now);
  sample.budget.noise = noise_mm(plan, now);
  sample.budget.reference_frame = noise_mm(plan, then);
  if (codec.is_lossy()) {
    const std::size_t i = sample.marker;
    sample.budget.codec =
        hypot3(codec_mm(reference, i, now, codec.at(n, i), Lag::kOwn),
               codec_mm(reference, i, then, codec.in_reference_frame(i), codec.lag_in_reference_frame(i)), {});
  }
  sample.u = hypot3(sample.budget.noise, sample.budget.reference_frame, sample.budget.codec);
  sample.status = quality(plan, then, now);
  withhold_unshown_axes(sample);
}

Solution conventional_in_noise(const Reference& reference, const Observations& observations, const CodecHistory& codec,
                               double excess) {
  Solution solution;
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation seen = with_noise(observations[n], excess);
    const bool moved = !seen.decode_error && camera_moved(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      Sample sample = initial_sample(reference, seen, i);
      if (seen.frame != reference.seen.frame) {
        if (seen.decode_error)
          sample.status = Status::kDecodeError;
        else if (seen.markers[i].loss != Loss::kNone)
          sample.status = status_of_loss(seen.markers[i].loss);
        else
          measure_phase(reference, seen, codec, n, sample);
        if (moved && seen.markers[i].loss == Loss::kNone) sample.status = Status::kCameraMoved;
      }
      solution.samples.push_back(sample);
    }
  }
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (is_target(reference, i)) follow_orders(reference, i, solution.samples);
  }
  return solution;
}

}  // namespace

Solution solve_conventional(const Reference& reference, const Observations& observations, const SolveOptions&) {
  return solve_in_own_noise(reference, observations, conventional_in_noise);
}

}  // namespace moiregauge::internal
