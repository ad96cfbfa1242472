// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/follow_marker.h"

#include <algorithm>

namespace moiregauge::internal {
namespace {

// A print whose window has no room to spare may stand so far (in pitches) off centre: the outermost taps weigh nothing.
constexpr double kOffCentre = 0.02;

// The window stays where it was, as in the paper, for as long as the print fills it: then displacement is counted in
// the print's own pitches, whatever scale the homography has there. Beyond that it travels with the print.
bool off_centre(const RasterPlan& plan, Extent<frame::Board> rest) {
  const double room = std::max(plan.clearance_mm, kOffCentre * plan.pitch_mm);
  return std::abs(rest.x) > room || std::abs(rest.y) > room;
}

}  // namespace

Loss loss_of(const PatchReading& then, const PatchReading& patch) {
  if (patch.valid) return is_gone(then, patch) ? Loss::kNoModulation : Loss::kNone;
  return patch.noise_sigma == 0.0 ? Loss::kOutsidePicture : Loss::kNoModulation;
}

void follow_marker(const GreyPicture& picture, const Reference& reference, const View& view, std::size_t i,
                   Extent<frame::Board> travel, MarkerObservation& seen, PatchWorkspace& work) {
  seen.loss = reference.plan_loss[i];
  if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) return;
  const RasterPlan& plan = reference.plans[i];
  seen.window_shift = off_centre(plan, travel) ? travel : Extent<frame::Board>{};
  seen.patch = read_patch(picture.luma, picture.bits, view, plan, seen.window_shift, work);
  const auto& then = reference.seen.markers[i].patch;
  if (seen.patch.valid) {
    const auto rest =
        known_part(displacement_at(plan, then, seen.patch, seen.window_shift) + (-1.0) * seen.window_shift);
    if (off_centre(plan, rest)) {
      seen.window_shift = seen.window_shift + rest;
      seen.patch = read_patch(picture.luma, picture.bits, view, plan, seen.window_shift, work);
    }
  }
  seen.loss = loss_of(then, seen.patch);
}

}  // namespace moiregauge::internal
