// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "moiregauge/observation/frame/follow_marker.h"
#include "moiregauge/observation/frame/neighbour_ambiguity.h"
#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/frame/occlusion.h"
#include "moiregauge/observation/frame/patch_of_points.h"
#include "moiregauge/observation/frame/track.h"
#include "moiregauge/observation/print/own_blur.h"

namespace moiregauge::internal {
namespace {

// Returns the displacement of a grating by the raster method, mm. Its error is about 0.01 px in this frame's view.
Extent<frame::Board> moved(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  return known_part(
      displacement_at(reference.plans[i], reference.seen.markers[i].patch, seen.patch, seen.window_shift));
}

// Search distance of a lost target from its last position, pitches. Chosen.
constexpr int kLostPitches = 12;
// Largest difference between the displacements of circle and grating. A circle determines the fringe order only below
// half a pitch. Chosen.
constexpr double kCircleLimit = 0.4;  // pitches

Order order_by_circle(const Reference& reference, const View& view, std::size_t i, const MarkerObservation& seen) {
  const auto& circle = reference.site.markers[i].circle;
  const auto& then = reference.seen.markers[i].circle;
  if (!circle || !seen.circle || !then) return Order::kUnproven;
  const auto went = (view.board(seen.circle->centre) - reference.view.board(then->centre)) - moved(reference, seen, i);
  return length(went) < kCircleLimit * reference.plans[i].pitch_mm ? Order::kProven : Order::kContradicted;
}

// Returns true if the target, displaced by `moved`, would overlap another marker's grating. Other targets count at
// their positions in the last frame.
bool is_over_another(const Site& site, std::size_t target, Extent<frame::Board> moved, const Prediction& prediction) {
  const Grating& own = *site.markers[target].grating;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (i == target || !site.markers[i].grating) continue;
    const Grating& other = *site.markers[i].grating;
    const bool travels = site.markers[i].role == Role::kTarget;
    const auto travel = travels ? prediction.last_travel(i) : Extent<frame::Board>{};
    const auto apart = own.centre + moved - (other.centre + travel);
    const double reach = 0.4 * (std::min(own.width_mm, own.height_mm) + std::min(other.width_mm, other.height_mm));
    if (length(apart) < reach) return true;
  }
  return false;
}

// Determines the fringe order of a target from its outline or its circle. Repeats the raster reading if continuity gave
// another order or lost the target.
void prove(const BoardPicture& now, const Reference& reference, std::size_t i, const Prediction& prediction,
           MarkerObservation& seen) {
  const auto& outline = reference.prints[i]->outline;
  const Grating& grating = *reference.site.markers[i].grating;
  const auto is_taken = [&](Extent<frame::Board> d) { return is_over_another(reference.site, i, d, prediction); };
  if (seen.loss != Loss::kNone && seen.loss != Loss::kTooCoarse && outline) {
    const auto found = search_print(now.picture.luma, now.view, {grating, prediction.last_travel(i)}, *outline,
                                    {kLostPitches, is_taken});
    if (found) follow_marker(now, reference, i, *found, seen);
  }
  if (seen.loss != Loss::kNone) return;
  if (!outline) {
    seen.order = order_by_circle(reference, now.view, i, seen);
    return;
  }
  const auto here = moved(reference, seen, i);
  const OrderVerdict verdict = verify_fringe_order(now.picture.luma, now.view, {grating, here}, *outline, is_taken);
  seen.order = verdict.order;
  if (verdict.order == Order::kProven && length(verdict.moved - here) > 0.0)
    follow_marker(now, reference, i, verdict.moved, seen);
}

// Fits the template of a marker. The raster reads a reference as covered if its window reaches beyond the grating. The
// template decides whether it is covered or has slipped.
void read(const BoardPicture& now, const Reference& reference, std::size_t i, MarkerObservation& seen) {
  if (!reference.prints[i]) return;
  const bool is_target = reference.site.markers[i].role == Role::kTarget;
  const bool may_have_slipped = !is_target && seen.loss == Loss::kCovered;
  if (seen.loss != Loss::kNone && !may_have_slipped) return;
  const bool is_elsewhere = is_target || may_have_slipped || length(seen.window_shift) > 0.0;
  const auto d = is_elsewhere ? moved(reference, seen, i) : Extent<frame::Board>{};
  const PrintModel& print = *reference.prints[i];
  auto points = read_points(now.picture.luma, now.view, {*reference.site.markers[i].grating, d}, print);
  if (!points) return;
  const auto& at_rest = reference.seen.markers[i].points;
  if (!at_rest) {  // in the reference frame
    seen.points = *std::move(points);
    return;
  }
  const CoveredBlocks covered = find_occluded_blocks(now.picture, print, *at_rest, *points);
  if (covered.any_now) {
    auto free = free_points(now.picture, print, *at_rest, *points, covered.now);
    if (!free) {
      seen.loss = Loss::kCovered;
      return;
    }
    *points = *std::move(free);
  } else if (may_have_slipped && !is_whole(*points, *at_rest, print, now.picture.rounding)) {
    return;
  }
  seen.occlusion = covered.any_now ? Occlusion::kNow : covered.any_then ? Occlusion::kAtRest : Occlusion::kNone;
  if (may_have_slipped)
    seen.patch =
        patch_of_points(reference, i, *points, motion_of_points(reference, now.view, i, *points), seen.window_shift);
  seen.loss = Loss::kNone;
  seen.points = *std::move(points);
}

}  // namespace

namespace {

// Largest position uncertainty of a surveyed site. The grating positions of such a site are symmetry points. For other
// sites the view through the circles is as good. Chosen.
constexpr double kSurveyed = 0.05;  // pitches
// Largest relative change of the distance from a circle to its grating by an unknown lens: 5 % at the image corner.
constexpr double kLensAcross = 0.02;
constexpr double kSureOfPlace = 3.0;  // coverage factor
// Share of a grating's pixels. A smaller share may be faulty pixels of the sensor. Chosen.
constexpr double kMinClipped = 0.01;

// Returns the radius (mm) around the predicted position of a reference's grating, in which its symmetry point is
// accepted as the site's. 0: the site does not know its positions well enough.
double origin_within(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const double u = reference.site.known_to.position_mm;
  if (marker.role != Role::kReference || !(u <= kSurveyed * marker.grating->pitch_mm)) return 0.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const CirclePoint& circle : reference.circles)
    nearest = std::min(nearest, length(circle.board - marker.grating->centre));
  const double by_lens = std::isfinite(nearest) ? kLensAcross * nearest : 0.0;
  return kSureOfPlace * std::hypot(u, by_lens, kSurveyed * marker.grating->pitch_mm);
}

}  // namespace

void learn_prints(const GreyPicture& picture, Reference& reference) {
  reference.prints.assign(reference.site.markers.size(), std::nullopt);
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    MarkerObservation& seen = reference.seen.markers[i];
    if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) continue;
    const Grating& grating = *reference.site.markers[i].grating;
    // Clipping acts as a tone curve, too.
    const bool in_light = reference.light_per_grey.empty() && seen.patch.clipped_share < kMinClipped;
    auto learned = learn_print(picture.luma, reference.view, grating,
                               {.use = reference.options.template_use,
                                .origin_within = origin_within(reference, i) / grating.pitch_mm,
                                .in_light = in_light});
    if (!learned) continue;
    reference.prints[i] = *std::move(learned);
    read({picture, reference.view}, reference, i, seen);
    PrintModel& print = *reference.prints[i];
    if (seen.points) print.misses = template_residuals(picture.luma, *seen.points, print.window, print.print);
  }
}

void fit_templates(const GreyPicture& picture, const Reference& reference, Observation& seen) {
  const View view{seen.stage2, reference.lens};
  for (std::size_t i = 0; i < seen.markers.size(); ++i) read({picture, view}, reference, i, seen.markers[i]);
}

namespace {

// Tracks a target. Returns false if it is not at its predicted position, or not in the fringe order of its outline.
bool tracked(const BoardPicture& now, const Reference& reference, std::size_t i, const Prediction& prediction,
             MarkerObservation& seen) {
  if (!reference.prints[i] || !reference.prints[i]->outline) return false;
  auto here = track_target(now, reference, i, prediction);
  if (!here) return false;
  const auto is_taken = [&](Extent<frame::Board> d) { return is_over_another(reference.site, i, d, prediction); };
  const auto shift = here->window_shift;
  if (is_taken(shift) ||
      !ends_with_print(*here->points, *reference.seen.markers[i].points, *reference.prints[i], now.picture.rounding)) {
    const OrderVerdict verdict =
        verify_fringe_order(now.picture.luma, now.view, {*reference.site.markers[i].grating, shift},
                            *reference.prints[i]->outline, is_taken);
    if (verdict.order != Order::kProven || length(verdict.moved - shift) > 0.0) return false;
  }
  seen = *std::move(here);
  seen.order = Order::kProven;
  return true;
}

// Reads a marker by outline and template. The raster must have read it first.
void look_for(const BoardPicture& now, const Reference& reference, std::size_t i, const Prediction& prediction,
              MarkerObservation& seen) {
  const bool may_move = reference.site.markers[i].role == Role::kTarget;
  if (may_move && reference.prints[i]) prove(now, reference, i, prediction, seen);
  read(now, reference, i, seen);
}

// Fits the markers of a role again with a template of this frame's blur, where that explains their residual. Returns
// true if one was fitted so.
bool fit_in_own_blur(const GreyPicture& picture, const Reference& reference, Role role, Observation& seen) {
  bool any = false;
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    MarkerObservation& marker = seen.markers[i];
    const bool is_read = marker.points && marker.loss == Loss::kNone && marker.occlusion == Occlusion::kNone;
    if (reference.site.markers[i].role != role || !is_read || !reference.prints[i]) continue;
    const auto& at_rest = reference.seen.markers[i].points;
    if (!at_rest) continue;
    auto fit = fit_in_own_blur(picture.luma, *reference.prints[i], *at_rest, *marker.points, picture.rounding);
    if (!fit) continue;
    marker.points = *std::move(fit);
    any = true;
  }
  return any;
}

// A camera that moves during the exposure blurs all gratings. Where only a target is blurred, an average over time
// inside the camera may be the cause, which delays the target. The larger residual then has to remain in its u.
void fit_in_own_blur(const GreyPicture& picture, const Reference& reference, Observation& seen) {
  if (fit_in_own_blur(picture, reference, Role::kReference, seen))
    (void)fit_in_own_blur(picture, reference, Role::kTarget, seen);
}

}  // namespace

Observation observe_precise(const GreyPicture& picture, const Reference& reference, const Prediction& prediction) {
  auto as_expected = track_references(picture, reference, prediction);
  if (as_expected) {
    Observation seen = *std::move(as_expected);
    const View view{seen.stage2, reference.lens};
    const BoardPicture now{picture, view};
    for (std::size_t i = 0; i < seen.markers.size(); ++i) {
      const Marker& marker = reference.site.markers[i];
      if (!marker.grating) continue;
      if (marker.role == Role::kReference) {
        // Those with a circle are tracked already.
        if (!marker.circle) read(now, reference, i, seen.markers[i]);
        continue;
      }
      if (tracked(now, reference, i, prediction, seen.markers[i])) continue;
      follow_marker(now, reference, i, prediction.last_travel(i), seen.markers[i]);
      look_for(now, reference, i, prediction, seen.markers[i]);
    }
    fit_in_own_blur(picture, reference, seen);
    flag_ambiguous_targets(reference, prediction, seen);
    return seen;
  }
  const std::size_t least = reference.knows_camera() ? kMinForPose : kMinForHomography;
  Observation seen = observe_board(picture, reference, prediction, least);
  if (!seen.references_seen) return seen;
  const View view{seen.stage2, reference.lens};
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    look_for({picture, view}, reference, i, prediction, seen.markers[i]);
  fit_in_own_blur(picture, reference, seen);
  flag_ambiguous_targets(reference, prediction, seen);
  return seen;
}

}  // namespace moiregauge::internal
