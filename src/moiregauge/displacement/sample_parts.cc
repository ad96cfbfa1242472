// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/sample_parts.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/observation/frame/patch_of_points.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Modulation relative to the reference frame below which the fringe is blurred and not only dimmer. Chosen.
constexpr double kBlurredModulation = 0.5;
// Additional share of clipped pixels that distorts the fringe. Chosen.
constexpr double kClippedShare = 0.05;
// u of a printed circle's centre from its outline, px, for references without a grating. Typical of real prints.
constexpr double kPrintedCirclePx = 0.03;

// Residual beyond noise relative to the template's contrast, rms, above which a grating is partly covered. It
// corresponds to a sixteenth of hidden grating. Blur by half a pitch, with the contrast fitted, leaves 0.17. Chosen.
constexpr double kHiddenContrast = 0.25;

// Distance from the position that the circles imply, in pitches, beyond which the next lattice line is possible. Half a
// pitch is the limit; the rest is margin. Chosen.
constexpr double kOrderLimit = 0.4;

// Least movement along the lines of a grating that u includes, pitches. A much larger one uncovers the end of the
// lines, which occlusion shows. Chosen.
constexpr double kAlongLines = 0.1;

// The board axis along lines that are parallel to it within 1.5 deg, and the one across them.
struct LinesAxes {
  double BoardExtent::*along;
  double BoardExtent::*across;
};
std::optional<LinesAxes> axes_of_lines(BoardExtent direction) {
  if (std::abs(direction.x) > kUpright) return LinesAxes{&BoardExtent::x, &BoardExtent::y};
  if (std::abs(direction.y) > kUpright) return LinesAxes{&BoardExtent::y, &BoardExtent::x};
  return std::nullopt;
}

}  // namespace

BoardExtent noise_mm(const RasterPlan& plan, const PatchReading& patch) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  const double u0 = plan.pitch_mm / kTwoPi * (plan.reads_x ? patch.u_phase_rad[0] : 0.0);
  const double u1 = plan.pitch_mm / kTwoPi * (plan.reads_y ? patch.u_phase_rad[1] : 0.0);
  return {std::hypot(c * u0, s * u1), std::hypot(s * u0, c * u1)};
}

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

Status status_of_loss(Loss loss) { return loss == Loss::kTooCoarse ? Status::kTooCoarse : Status::kLost; }

Status sharpness(const PatchReading& then, const PatchReading& now, double clipped_before) {
  if (now.clipped_share > clipped_before + kClippedShare) return Status::kSaturated;
  for (std::size_t a = 0; a < 2; ++a) {
    if (now.modulation[a] < kBlurredModulation * then.modulation[a]) return Status::kBlurred;
  }
  return Status::kOk;
}

Status quality(const RasterPlan& plan, const PatchReading& then, const PatchReading& now) {
  return is_bent(plan, then, now) ? Status::kPartlyCovered : sharpness(then, now);
}

Status image_status(const Reference& reference, const MarkerObservation& seen, std::size_t marker) {
  const MarkerObservation& at_first = reference.seen.markers[marker];
  // Paper that is clipped in both frames is in the template, too, and the edges of dark lines remain.
  const Status sharp = sharpness(at_first.patch, seen.patch, at_first.patch.clipped_share);
  if (sharp != Status::kOk || !seen.points || !at_first.points) return sharp;
  if (seen.occlusion != Occlusion::kNone) return Status::kPartlyCovered;
  const double missing = missing_contrast(*seen.points, *at_first.points, *reference.prints[marker],
                                          rounding_of_step(reference.step_of(marker, seen.quantiser)));
  return missing > kHiddenContrast ? Status::kPartlyCovered : Status::kOk;
}

BoardExtent with_movement_along_lines(const Grating& grating, BoardExtent displacement) {
  const auto lines = direction_of_lines(grating);
  const auto axes = lines ? axes_of_lines(*lines) : std::nullopt;
  if (axes) displacement.*axes->along = std::hypot(kAlongLines * grating.pitch_mm, displacement.*axes->across);
  return displacement;
}

void add_movement_along_lines(const Grating& grating, double u_rotation_rad, Sample& sample) {
  const auto lines = direction_of_lines(grating);
  if (!lines) return;
  const auto axes = axes_of_lines(*lines);
  if (!axes) {
    sample.displacement = {kNotMeasured, kNotMeasured};
    return;
  }
  const double moved = with_movement_along_lines(grating, sample.displacement).*axes->along;
  double& part = sample.budget.axis.*axes->across;
  part = std::hypot(part, moved * std::hypot((*lines).*axes->across, u_rotation_rad));
  sample.displacement.*axes->along = kNotMeasured;
}

void withhold_unshown_axes(Sample& sample) {
  for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
    if (std::isnan(sample.displacement.*axis)) sample.u.*axis = kNotMeasured;
  }
}

std::vector<bool> references_in_doubt(const Reference& reference, const Observation& seen) {
  std::vector<bool> doubtful(seen.markers.size(), false);
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    if (!reference.site.markers[i].grating || seen.markers[i].loss != Loss::kNone) continue;
    // A slipped reference was found by its circle. Test it about that position.
    const BoardExtent slip = seen.markers[i].window_shift;
    const auto moved =
        displacement_at(reference.plans[i], reference.seen.markers[i].patch, seen.markers[i].patch, slip);
    const auto along = raster_from_board(reference.plans[i], moved - slip);
    for (const double d : along) {
      if (std::abs(d) > kOrderLimit * reference.plans[i].pitch_mm) doubtful[i] = true;
    }
  }
  return doubtful;
}

bool order_in_doubt(const Reference& reference, const Observation& seen) {
  const auto doubtful = references_in_doubt(reference, seen);
  return std::find(doubtful.begin(), doubtful.end(), true) != doubtful.end();
}

bool is_target(const Reference& reference, std::size_t i) {
  return reference.site.markers[i].role == Role::kTarget && reference.site.markers[i].grating.has_value();
}

Sample initial_sample(const Reference& reference, const Observation& seen, std::size_t marker) {
  if (seen.frame == reference.seen.frame)
    return {seen.frame, seen.time_s, marker, {0.0, 0.0}, {0.0, 0.0}, {}, Status::kOk};
  Sample sample;
  sample.frame = seen.frame;
  sample.time_s = seen.time_s;
  sample.marker = marker;
  return sample;
}

}  // namespace moiregauge::internal
