// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/overlay.h"

#include <algorithm>

#include "moiregauge/drawing/overlays/overlay_pen.h"
#include "moiregauge/drawing/overlays/scale_bar.h"
#include "moiregauge/drawing/surface/png_bytes.h"

namespace moiregauge::internal {
namespace {

using namespace overlay;

// Reserves the markers' areas, so that labels and scale bar do not cover them.
void reserve_markers(Pen& pen, const Reference& reference) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const auto& circle = reference.seen.markers[i].circle;
    if (marker.circle && circle) pen.keep_free(pen.page_box(corners_round(circle->centre, circle->diameter_px)));
    if (!marker.grating) continue;
    const Grating& g = *marker.grating;
    pen.keep_free(pen.page_box(outline(reference.view, g.centre, g.width_mm, g.height_mm, g.angle_rad)));
  }
}

void draw_markers(Pen& pen, const Reference& reference, const Box& page) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const MarkerObservation& seen = reference.seen.markers[i];
    pen.colour(marker.role == Role::kReference ? kReferenceColour : kTargetColour);
    std::vector<ImagePoint> about;
    if (marker.circle && seen.circle) {
      const DetectedCircle& c = *seen.circle;
      pen.ellipse(c);
      pen.cross(c.centre, 6.0);
      about = corners_round(c.centre, c.diameter_px);
    }
    if (marker.grating) {
      const Grating& g = *marker.grating;
      const auto corners = outline(reference.view, g.centre, g.width_mm, g.height_mm, g.angle_rad);
      pen.polygon(corners);
      const RasterPlan& plan = reference.plans[i];
      if (plan.side_px > 0) {
        const double side = plan.region_px * plan.step_mm;
        pen.polygon(outline(reference.view, g.centre, side, side, plan.angle_rad));
      }
      pen.cross(reference.view(g.centre), 6.0);
      if (about.empty()) about = corners;
    }
    if (!about.empty()) pen.label_outside(about, marker.name, page);
  }
}

}  // namespace

std::vector<std::uint8_t> draw_overlay(const OverlayContents& contents) {
  const int width = contents.picture.width, height = contents.picture.height;
  const Surface surface = page_with(contents.picture, 1, width, height);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return {};
  const Context context(cairo_create(surface.get()), cairo_destroy);
  const Box page{0.0, 0.0, static_cast<double>(width), static_cast<double>(height)};
  Pen pen(context.get(), std::max(1.0, std::max(width, height) / 1400.0));  // lines and letters scale with the image
  if (contents.reference != nullptr) reserve_markers(pen, *contents.reference);
  if (!contents.caption.empty()) {
    pen.colour(kWhite);
    pen.label(8.0 * pen.unit(), 16.0 * pen.unit(), contents.caption, page);
  }
  if (contents.reference != nullptr) {
    draw_markers(pen, *contents.reference, page);
    draw_scale_bar(pen, *contents.reference, 1.0, "mm", page);
  }
  return png_of(surface.get());
}

}  // namespace moiregauge::internal
