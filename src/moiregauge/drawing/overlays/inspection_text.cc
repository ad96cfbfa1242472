// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/overlays/inspection_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Formats with two significant digits, as usual for an uncertainty.
std::string two_digits(double value) {
  const int decimals = value > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(value))), 0, 9) : 1;
  return fmt::format("{:.{}f}", value, decimals);
}

std::string axis_text(double value, const char* unit, const char* axis) {
  if (!std::isfinite(value)) return fmt::format("not measured along {}", axis);
  return fmt::format("{} {} along {}", two_digits(value), unit, axis);
}

bool is_near(const IndexedLattice& lattice, ImagePoint p) {
  return std::any_of(lattice.points.begin(), lattice.points.end(),
                     [&](const LatticePoint& q) { return length(q.at - p) < 0.75 * lattice.pitch_px; });
}

bool is_part(const Inspection& seen, ImagePoint p) {
  return std::any_of(seen.patches.begin(), seen.patches.end(),
                     [&](const auto& patch) { return holds(patch.seen, p); }) ||
         std::any_of(seen.lattices.begin(), seen.lattices.end(), [&](const auto& l) { return is_near(l, p); }) ||
         std::any_of(seen.circles.begin(), seen.circles.end(),
                     [&](const auto& c) { return length(c.seen.centre - p) < 0.5 * c.seen.diameter_px; });
}

double direction_deg(ImageExtent along) { return degrees_from_radians(std::atan2(-along.y, along.x)); }

}  // namespace

std::vector<const RejectedOutline*> rejected_elsewhere(const Inspection& seen) {
  std::vector<const RejectedOutline*> out;
  for (const RejectedOutline& r : seen.rejected) {
    if (!is_part(seen, r.centre)) out.push_back(&r);
  }
  return out;
}

std::string name_of(const Inspection& seen, int marker) {
  return marker == kUnidentified ? "-" : seen.reference->site.markers[static_cast<std::size_t>(marker)].name;
}

std::string pattern_text(const DetectedPatch& patch) {
  std::string pattern = patch.pattern == Pattern::kAuto ? "grid or squares" : word_for(patch.pattern);
  if (patch.pattern == Pattern::kCheckerboard || patch.pattern == Pattern::kCosine) return pattern;
  return pattern + (patch.dark_on_light ? ", dark on light" : ", light on dark");
}

std::string pitch_text(const DetectedPatch& patch) {
  const PatchAxes axes = axes_of(patch);
  if (length(axes.y) == 0.0)
    return fmt::format("pitch {:.2f} px along x, x at {:+.1f} deg", length(axes.x), direction_deg(axes.x));
  if (length(axes.x) == 0.0)
    return fmt::format("pitch {:.2f} px along y, y at {:+.1f} deg", length(axes.y), direction_deg(axes.y));
  return fmt::format("pitch {:.2f} x {:.2f} px, x at {:+.1f} deg, y at {:+.1f} deg", length(axes.x), length(axes.y),
                     direction_deg(axes.x), direction_deg(axes.y));
}

std::string lattice_text(const IndexedLattice& lattice) {
  return fmt::format("{} {} x {}, {} of {}", lattice.kind == LatticeKind::kDots ? "dots" : "checker corners",
                     lattice.columns, lattice.rows, lattice.points.size(), lattice.columns * lattice.rows);
}

std::string both_axes(double x, double y, const char* unit) {
  return axis_text(x, unit, "x") + ", " + axis_text(y, unit, "y");
}

std::string expected_text(const Inspection& seen, const ExpectedUncertainty& e) {
  const Reference& reference = *seen.reference;
  if (reference.seen.markers[e.marker].loss != Loss::kNone) return "not found";
  if (seen.unit == BoardUnit::kMillimetre) {
    const double largest = std::fmax(e.u.x, e.u.y);
    const bool small = largest < 0.1;
    const double per_mm = small ? 1000.0 : 1.0;
    return "u = " + both_axes(per_mm * e.u.x, per_mm * e.u.y, small ? "µm" : "mm");
  }
  const double px_per_mm = 1.0 / reference.view.mm_per_px(reference.site.markers[e.marker].grating->centre);
  return "u = " + both_axes(px_per_mm * e.u.x, px_per_mm * e.u.y, "px");
}

}  // namespace moiregauge::internal
