// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_prior.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/calibration/rolling_shutter/row_motion.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {
namespace {

constexpr double kRestPlace = 100.0;  // mm: where a target rests is not known beforehand

// A template learned from one picture reads the scale of its print no better than this at the print's edge: what it
// cannot hold, harmonics beyond the pixels', is odd about every printed edge and passes for a little scale. Noise-free
// pictures show 0.0004 px at pitches of 29 px, 0.0025 px at 14 px; it is the same in all frames, so the bundle cannot
// see it.
constexpr double kTemplateEdgePx = 0.003;
// It is learned through the lens as it is known then. Of one that is not, a print's own bend leaks into its scale, for
// its window is not of whole pitches (-2 % at the small rig's corner: 0.004 px; -3 % at the rig's: 0.002 px). Only
// references are so far outside; a target's scale also multiplies its displacement, which knows nothing of how its
// template was learned.
constexpr double kUnknownLensEdgePx = 0.005;

void widen_scales(const Reference& reference, ScenePrior& prior) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const auto& grating = reference.site.markers[i].grating;
    if (!grating) continue;
    const double edge_px = reference.knows_camera() || is_target(reference, i) ? kTemplateEdgePx : kUnknownLensEdgePx;
    const double half_px =
        0.5 * std::min(grating->width_mm, grating->height_mm) / reference.view.mm_per_px(grating->centre);
    double& u = prior.u_markers[i].value[MarkerShape::kScale];
    if (u > 0.0) u = std::hypot(u, edge_px / half_px);
  }
}

// A place is known no better than the symmetry point it is stated for.
void widen_places(const Reference& reference, ScenePrior& prior) {
  for (std::size_t i = 0; i < reference.site.markers.size() && i < reference.prints.size(); ++i) {
    if (is_target(reference, i) || !reference.prints[i] || !reference.site.markers[i].grating) continue;
    const double u_mm = reference.prints[i]->u_origin * reference.site.markers[i].grating->pitch_mm;
    for (const int axis : {MarkerShape::kX, MarkerShape::kY}) {
      double& u = prior.u_markers[i].value[static_cast<std::size_t>(axis)];
      u = std::hypot(u, u_mm);
    }
  }
}

}  // namespace

ScenePrior precise_prior(const Reference& reference, const SolveOptions& options) {
  const bool lens_given = reference.knows_camera();
  ScenePrior prior = scene_prior(reference.site, reference.width, reference.height,
                                 lens_given ? std::optional(reference.lens) : std::nullopt);
  for (std::size_t k = 0; lens_given && options.u_camera && k < prior.u_camera.size(); ++k) {
    if (std::isfinite((*options.u_camera)[k])) prior.u_camera[k] = (*options.u_camera)[k];
  }
  widen_scales(reference, prior);
  widen_places(reference, prior);
  prior.rows_run = rows_run(options.rotation_deg);
  for (std::size_t i = 0; options.rest && i < reference.site.markers.size(); ++i) {
    auto& u = prior.u_markers[i].value;
    if (is_target(reference, i)) u[MarkerShape::kX] = u[MarkerShape::kY] = kRestPlace;
  }
  return prior;
}

}  // namespace moiregauge::internal
