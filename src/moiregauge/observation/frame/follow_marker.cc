// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/follow_marker.h"

#include <algorithm>

namespace moiregauge::internal {
namespace {

// Largest offset of a grating whose window has no clearance, pitches. The outermost taps have almost no weight. Chosen.
constexpr double kOffCentre = 0.02;

// Returns true if the window must move. As in the paper it is fixed as long as the grating fills it. Displacement is
// then counted in the grating's own pitches, whatever the scale of the homography.
bool off_centre(const RasterPlan& plan, Extent<frame::Board> rest) {
  const double room = std::max(plan.clearance_mm, kOffCentre * plan.pitch_mm);
  return std::abs(rest.x) > room || std::abs(rest.y) > room;
}

}  // namespace

Loss loss_of(const PatchReading& then, const PatchReading& patch) {
  if (patch.valid) return is_lost(then, patch) ? Loss::kNoModulation : Loss::kNone;
  return patch.noise_sigma == 0.0 ? Loss::kOutsidePicture : Loss::kNoModulation;
}

void follow_marker(const BoardPicture& now, const Reference& reference, std::size_t i, Extent<frame::Board> travel,
                   MarkerObservation& seen) {
  seen.loss = reference.plan_loss[i];
  if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) return;
  const RasterPlan& plan = reference.plans[i];
  seen.window_shift = off_centre(plan, travel) ? travel : Extent<frame::Board>{};
  seen.patch = read_patch(now.picture.luma, now.picture.bits, now.view, plan, seen.window_shift);
  const auto& then = reference.seen.markers[i].patch;
  if (seen.patch.valid) {
    const auto rest =
        known_part(displacement_at(plan, then, seen.patch, seen.window_shift) + (-1.0) * seen.window_shift);
    if (off_centre(plan, rest)) {
      seen.window_shift = seen.window_shift + rest;
      seen.patch = read_patch(now.picture.luma, now.picture.bits, now.view, plan, seen.window_shift);
    }
  }
  seen.loss = loss_of(then, seen.patch);
}

}  // namespace moiregauge::internal
