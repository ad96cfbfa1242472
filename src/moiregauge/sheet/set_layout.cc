// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sheet/set_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace moiregauge::internal::sheet {
namespace {

// Diameter of the marked circle, relative to the others. Identification distinguishes it by nine of its standard
// deviations of 2.5 %.
constexpr double kMarkedCircle = 1.25;
constexpr double kReferencePitches = 4.0, kTargetPitches = 6.0, kCirclePitches = 2.0;

double or_else(double stated, double otherwise) { return stated > 0.0 ? stated : otherwise; }

struct Sizes {
  double reference, target, circle;
  double apart;  // centre distance of a reference's circle and grating
};

Sizes sizes_of(const SetRequest& r) {
  Sizes s{or_else(r.reference_size_mm, kReferencePitches * r.pitch_mm),
          or_else(r.target_size_mm, kTargetPitches * r.pitch_mm),
          or_else(r.circle_diameter_mm, kCirclePitches * r.pitch_mm), 0.0};
  s.apart = 0.5 * s.reference + r.pitch_mm + 0.5 * s.circle;
  return s;
}

Grating grating_at(const SetRequest& r, BoardPoint centre, double size) {
  Grating g;
  g.centre = centre;
  g.width_mm = g.height_mm = size;
  g.pitch_mm = r.pitch_mm;
  g.pattern = r.pattern;
  return g;
}

// Returns a reference with its circle at `circle`, and the grating to the right (side 1) or left (-1) of it. Its
// pattern must show both axes.
Marker reference(const SetRequest& r, const char* name, BoardPoint circle, double side) {
  const Sizes s = sizes_of(r);
  Marker marker;
  marker.name = name;
  marker.circle = Circle{circle, s.circle};
  marker.grating = grating_at(r, {circle.x + side * s.apart, circle.y}, s.reference);
  if (r.pattern == Pattern::kLinesX || r.pattern == Pattern::kLinesY) marker.grating->pattern = Pattern::kGrid;
  return marker;
}

// Adds two references above and below the centre. If a target is in the way, they are shifted by a quarter of the
// width.
void add_inner_references(const SetRequest& r, std::vector<Marker>& markers) {
  const Sizes s = sizes_of(r);
  const bool is_flat = 0.5 * r.span.y < 0.5 * s.target + 0.5 * s.reference + r.pitch_mm;
  const double aside = is_flat ? 0.25 * r.span.x : 0.0, y = 0.5 * r.span.y;
  // Centres the pair: half the distance of circle and grating, corrected by the difference of their sizes.
  const double half = 0.5 * s.apart + 0.25 * (s.reference - s.circle);
  markers.push_back(reference(r, "N", {std::round(-aside - half), y}, 1.0));
  markers.push_back(reference(r, "S", {std::round(aside + half), -y}, -1.0));
}

void add_targets(const SetRequest& r, std::vector<Marker>& markers) {
  const Sizes s = sizes_of(r);
  const double inner = 0.5 * r.span.x - s.apart;  // centre of the outer references' gratings
  for (int i = 0; i < r.targets; ++i) {
    const double x = std::round(inner * (2.0 * (i + 1) / (r.targets + 1) - 1.0));
    Marker marker;
    marker.name = fmt::format("T{}", i + 1);
    marker.role = Role::kTarget;
    marker.grating = grating_at(r, {x, 0.0}, s.target);
    markers.push_back(marker);
  }
}

void include(Box& box, BoardPoint centre, double half_x, double half_y) {
  box.low = {std::min(box.low.x, centre.x - half_x), std::min(box.low.y, centre.y - half_y)};
  box.high = {std::max(box.high.x, centre.x + half_x), std::max(box.high.y, centre.y + half_y)};
}

Box nothing() {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  return {{kFar, kFar}, {-kFar, -kFar}};
}

}  // namespace

Box extent_of(const Marker& marker) {
  Box box = nothing();
  if (marker.circle)
    include(box, marker.circle->centre, 0.5 * marker.circle->diameter_mm, 0.5 * marker.circle->diameter_mm);
  if (marker.grating) {
    const Grating& g = *marker.grating;
    const double c = std::abs(std::cos(g.angle_rad)), s = std::abs(std::sin(g.angle_rad));
    include(box, g.centre, 0.5 * (c * g.width_mm + s * g.height_mm), 0.5 * (s * g.width_mm + c * g.height_mm));
  }
  return box;
}

Box extent_of(const std::vector<Marker>& markers) {
  Box all = nothing();
  for (const Marker& marker : markers) {
    const Box box = extent_of(marker);
    include(all, box.middle(), 0.5 * box.width(), 0.5 * box.height());
  }
  return all;
}

double quiet_zone_mm(const Marker& marker) {
  return std::max(marker.grating ? marker.grating->pitch_mm : 0.0,
                  marker.circle ? 0.5 * marker.circle->diameter_mm : 0.0);
}

double gap_between(const Box& a, const Box& b) {
  return std::max({a.low.x - b.high.x, b.low.x - a.high.x, a.low.y - b.high.y, b.low.y - a.high.y});
}

tl::expected<Site, std::string> site_of_set(const SetRequest& r) {
  const Sizes s = sizes_of(r);
  const double x = 0.5 * r.span.x, y = 0.5 * r.span.y;
  Site site;
  // The larger circle reveals a mirrored image, and sheets that are upside down or rotated by 180 degrees.
  site.markers = {reference(r, "NW", {-x, y}, 1.0), reference(r, "NE", {x, y}, -1.0), reference(r, "SW", {-x, -y}, 1.0),
                  reference(r, "SE", {x, -y}, -1.0)};
  site.markers.front().circle->diameter_mm = kMarkedCircle * s.circle;
  if (r.references == 6) add_inner_references(r, site.markers);
  add_targets(r, site.markers);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    for (std::size_t k = i + 1; k < site.markers.size(); ++k) {
      if (gap_between(extent_of(site.markers[i]), extent_of(site.markers[k])) >= r.pitch_mm - 1e-9) continue;
      return tl::unexpected(
          fmt::format("'{}' and '{}' are less than a pitch apart (span {:g} x {:g} mm, references {:g} mm, targets "
                      "{:g} mm, circles "
                      "{:g} mm). Choose a wider --span, fewer targets or a smaller --pitch",
                      site.markers[i].name, site.markers[k].name, r.span.x, r.span.y, s.reference, s.target, s.circle));
    }
  }
  return site;
}

Extent<frame::Board> widest_span(const SetRequest& r, Extent<frame::Board> room) {
  const Sizes s = sizes_of(r);
  const double quiet = std::max(r.pitch_mm, 0.5 * kMarkedCircle * s.circle);
  const auto rounded = [](double mm) { return mm > 100.0 ? 10.0 * std::floor(0.1 * mm) : std::floor(mm); };
  return {rounded(room.x - kMarkedCircle * s.circle - 2.0 * quiet),
          rounded(room.y - std::max(kMarkedCircle * s.circle, s.reference) - 2.0 * quiet)};
}

std::optional<double> fitting_pitch(SetRequest r, std::optional<Extent<frame::Board>> room) {
  constexpr double kSmallestShare = 0.1;  // relative to the requested pitch; chosen
  const double largest = r.pitch_mm, step = 0.05 * std::pow(10.0, std::floor(std::log10(largest)));
  for (double steps = std::ceil(largest / step) - 1.0; steps * step >= kSmallestShare * largest; steps -= 1.0) {
    r.pitch_mm = steps * step;
    if (room) r.span = widest_span(r, *room);
    if (r.span.x > 0.0 && r.span.y > 0.0 && site_of_set(r)) return r.pitch_mm;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal::sheet
