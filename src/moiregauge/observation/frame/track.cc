// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/track.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/observation/frame/discs_near.h"
#include "moiregauge/observation/frame/occlusion.h"
#include "moiregauge/observation/frame/patch_of_points.h"

namespace moiregauge::internal {
namespace {

// Limit of a fit's last step, pitches. A larger one started too far away. Chosen.
constexpr double kConverged = 0.005;
// Largest distance of a reference from the position that the circles imply, pitches. Beyond it the reference may be on
// the next lattice line. Chosen.
constexpr double kTrackFarOff = 0.3;

bool expects_all(const Reference& reference, const Prediction& prediction) {
  if (!prediction.expected || reference.prints.size() != reference.site.markers.size()) return false;
  for (const CirclePoint& point : reference.circles) {
    if (!reference.prints[point.marker] || !reference.seen.markers[point.marker].points) return false;
  }
  return !reference.circles.empty();
}

std::optional<PatchFit> fitted(const BoardPicture& now, const Reference& reference, std::size_t i,
                               Extent<frame::Board> moved, Rows rows) {
  const PrintModel& print = *reference.prints[i];
  auto fit = read_points(now.picture.luma, now.view, {*reference.site.markers[i].grating, moved}, print, rows);
  if (!fit || (rows == Rows::kAll && !(fit->last_step < kConverged)) ||
      !is_whole(*fit, *reference.seen.markers[i].points, print, now.picture.rounding))
    return std::nullopt;
  const CoveredBlocks covered = find_occluded_blocks(now.picture, print, *reference.seen.markers[i].points, *fit, rows);
  if (covered.any_now || covered.any_then) return std::nullopt;
  return *std::move(fit);
}

}  // namespace

std::optional<Observation> track_references(const GreyPicture& picture, const Reference& reference,
                                            const Prediction& prediction, Rows rows) {
  if (!expects_all(reference, prediction)) return std::nullopt;
  Identified who;
  const auto search = discs_near(picture, reference, *prediction.expected, rows, who);
  if (!search) return std::nullopt;
  const auto points = circle_points(reference.site, reference.lens, *search, who);
  const auto first = fit_circles(points);
  if (!first) return std::nullopt;
  Observation seen;
  seen.markers.resize(reference.site.markers.size());
  seen.stage1 = *first;
  const View view{*first, reference.lens};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t i = points[k].marker;
    MarkerObservation& marker = seen.markers[i];
    auto fit = fitted({picture, view}, reference, i, {}, rows);
    if (!fit) return std::nullopt;
    const PrintMotion motion = motion_of_points(reference, view, i, *fit);
    if (length(motion.displacement) > kTrackFarOff * reference.plans[i].pitch_mm) return std::nullopt;
    marker.circle = search->circles[k];
    marker.patch = patch_of_points(reference, i, *fit, motion, {});
    if (rows == Rows::kAll) marker.patch.clipped_share = clipped_share(picture, *fit);
    marker.points = *std::move(fit);
    marker.loss = Loss::kNone;
  }
  const auto second = second_view(reference, points, seen);
  if (!second) return std::nullopt;
  seen.stage2 = *second;
  seen.references_seen = true;
  return seen;
}

std::optional<MarkerObservation> track_target(const BoardPicture& now, const Reference& reference, std::size_t i,
                                              const Prediction& prediction, Rows rows) {
  if (!reference.prints[i] || !reference.seen.markers[i].points || !(i < prediction.travel_expected.size()))
    return std::nullopt;
  auto fit = fitted(now, reference, i, prediction.travel_expected[i], rows);
  if (!fit) return std::nullopt;
  const PrintMotion motion = motion_of_points(reference, now.view, i, *fit);
  std::optional<MarkerObservation> seen(std::in_place);
  seen->window_shift = motion.displacement;
  seen->patch = patch_of_points(reference, i, *fit, motion, seen->window_shift);
  if (rows == Rows::kAll) seen->patch.clipped_share = clipped_share(now.picture, *fit);
  seen->points = *std::move(fit);
  seen->loss = Loss::kNone;
  return seen;
}

}  // namespace moiregauge::internal
