// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_prior.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/calibration/rolling_shutter/row_motion.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/print/print_origin.h"

namespace moiregauge::internal {
namespace {

constexpr double kRestPlace = 100.0;  // mm, prior u of a target's rest position: practically unknown

// Error of a grating's scale from one image, px at its edge. The template cannot contain harmonics beyond those of the
// pixels. They are odd about every edge and act as a scale error. Noise-free images show 0.0004 px for a pitch of 29 px
// and 0.0025 px for 14 px. The error is the same in all frames, so the bundle adjustment cannot see it.
constexpr double kTemplateEdgePx = 0.003;
// The same for references through an unknown lens. The grating's bend enters its scale, because the window is not a
// whole number of pitches. Noise-free images show 0.004 px for -2 % at the small rig's corner and 0.002 px for -3 % at
// the rig's. Targets are not as far outside, and their scale multiplies the displacement.
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

// Adds the uncertainty of the symmetry point to the prior of the position.
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

// Largest part of a grating's half size that its window may lack, pitches. The window ends before the edge of the grating,
// by up to three sigma of blur. A covered grating lacks more. Chosen.
constexpr double kWholeWithin = 0.5;

constexpr double kSamePoint = 0.1;  // pitches: symmetry points are 0.35 apart or more

bool is_whole(double half, double size_mm, double pitch_mm) { return half > 0.5 * size_mm / pitch_mm - kWholeWithin; }

// Returns the symmetry point nearest to a point of the grating, pitches.
std::optional<RotationCentre> symmetry_point(const PrintModel& model, PrintPoint near, double pitch_mm) {
  const auto own = nearest_symmetry(with_origin(model.print, near), model.options.along_x, model.options.along_y);
  if (!own) return std::nullopt;
  return RotationCentre{{near.x + own->at.x, near.y + own->at.y}, own->u * pitch_mm, true};
}

RotationCentre rotation_centre(const Grating& grating, Extent<frame::Board> shift, const PrintModel& model,
                               double u_mm) {
  const PatchWindow& window = model.window;
  const double c = std::cos(grating.angle_rad) / grating.pitch_mm, s = std::sin(grating.angle_rad) / grating.pitch_mm;
  const PrintPoint stated{-c * shift.x - s * shift.y, s * shift.x - c * shift.y};
  const auto middle = symmetry_point(model, window.centre, grating.pitch_mm);
  const auto nearest = symmetry_point(model, stated, grating.pitch_mm);
  if (!middle || !nearest) return {stated, std::hypot(u_mm, length(shift))};
  const bool is_same = std::hypot(middle->at.x - nearest->at.x, middle->at.y - nearest->at.y) < kSamePoint;
  const bool is_sure = is_same || (is_whole(window.half_x, grating.width_mm, grating.pitch_mm) &&
                                   is_whole(window.half_y, grating.height_mm, grating.pitch_mm));
  return is_sure ? *middle : RotationCentre{stated, std::hypot(u_mm, length(shift))};
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

std::vector<RotationCentre> rotation_centres(const Reference& reference, const FrameFit& then) {
  const Site& site = reference.site;
  std::vector<RotationCentre> out(site.markers.size());
  for (std::size_t i = 0; i < out.size() && i < reference.prints.size(); ++i) {
    if (!then.ok || then.shift_row[i] < 0 || !reference.prints[i]) continue;
    out[i] = rotation_centre(*site.markers[i].grating, then.shift[i], *reference.prints[i], site.known_to.position_mm);
  }
  return out;
}

}  // namespace moiregauge::internal
