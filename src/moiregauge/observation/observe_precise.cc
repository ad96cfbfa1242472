// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "moiregauge/observation/observe.h"

namespace moiregauge {
namespace {

// Where the print hangs, by the raster method: within a hundredth of a pixel of the truth in this frame's view.
Extent<frame::Board> moved(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const auto d = displacement_at(reference.plans[i], reference.seen.markers[i].patch, seen.patch, seen.window_shift);
  return {std::isnan(d.x) ? 0.0 : d.x, std::isnan(d.y) ? 0.0 : d.y};
}

void read(const GreyPicture& picture, const Reference& reference, const View& view, std::size_t i,
          MarkerObservation& seen) {
  if (seen.loss != Loss::kNone || !reference.prints[i]) return;
  const bool is_target = reference.site.markers[i].role == Role::kTarget;
  const auto d = is_target ? moved(reference, seen, i) : Extent<frame::Board>{};
  const auto points = read_points(picture.luma, view, *reference.site.markers[i].grating, d, *reference.prints[i]);
  if (points) seen.points = *points;
}

}  // namespace

void learn_prints(const GreyPicture& picture, Reference& reference) {
  reference.prints.assign(reference.site.markers.size(), std::nullopt);
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    MarkerObservation& seen = reference.seen.markers[i];
    if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) continue;
    auto learned = learn_print(picture.luma, reference.view, *reference.site.markers[i].grating, {});
    if (!learned) continue;
    reference.prints[i] = *std::move(learned);
    read(picture, reference, reference.view, i, seen);
  }
}

Observation observe_precise(const GreyPicture& picture, const Reference& reference, const Prediction& prediction,
                            PatchWorkspace& work) {
  Observation seen = observe_two_stage(picture, reference, prediction, work);
  if (!seen.references_seen) return seen;
  const View view{seen.stage2, reference.lens};
  for (std::size_t i = 0; i < seen.markers.size(); ++i) read(picture, reference, view, i, seen.markers[i]);
  return seen;
}

}  // namespace moiregauge
