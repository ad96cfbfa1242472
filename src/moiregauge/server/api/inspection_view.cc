// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/inspection_view.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/server/api/marker_outline.h"

namespace moiregauge::internal {
namespace {

using ViewJson = nlohmann::ordered_json;

ViewJson view_number(double value) { return std::isfinite(value) ? ViewJson(value) : ViewJson(nullptr); }

ViewJson circle_view(const DetectedCircle& circle) {
  return {{"x", circle.centre.x},
          {"y", circle.centre.y},
          {"diameter_px", circle.diameter_px},
          {"axis_ratio", circle.axis_ratio},
          {"angle_rad", circle.angle_rad}};
}

ViewJson grating_view(const InspectedPatch& patch) {
  ViewJson outline = ViewJson::array();
  for (const ImagePoint& corner : patch.seen.outline) outline.push_back({corner.x, corner.y});
  const PatchAxes axes = axes_of(patch.seen);
  return {{"outline", outline},
          {"pitch_px", view_number(std::max(length(axes.x), length(axes.y)))},
          {"pattern", word_for(patch.seen.pattern)},
          {"modulation", patch.seen.modulation}};
}

// Distance within which an object is a marker that another inspection of the same frame has named (chosen).
constexpr double kSamePlace_px = 3.0;

// An object that was detected and identified as no marker of the choice.
ViewJson unidentified(const char* part, ViewJson view, ImagePoint at, const NamedPositions& ignored) {
  for (const auto& [name, position] : ignored) {
    if (length(position - at) < kSamePlace_px) return {{"name", name}, {"role", "ignored"}, {part, std::move(view)}};
  }
  return {{"name", ""}, {"role", "none"}, {part, std::move(view)}};
}

ViewJson marker_view(const InspectReport& report, std::size_t i) {
  const Inspection& seen = report.seen;
  const Marker& marker = seen.reference->site.markers[i];
  const int number = static_cast<int>(i);
  ViewJson view{{"name", marker.name}, {"role", marker.role == Role::kReference ? "reference" : "target"}};
  if (const auto circle = std::ranges::find(seen.circles, number, &InspectedCircle::marker);
      circle != seen.circles.end())
    view["circle"] = circle_view(circle->seen);
  const auto patch = std::ranges::find(seen.patches, number, &InspectedPatch::marker);
  if (patch != seen.patches.end())
    view["grating"] = grating_view(*patch);
  else if (marker.grating)
    view["grating"] = {{"outline", grating_outline(seen.reference->view, *marker.grating, {})}};
  if (marker.grating)
    view["pitch_px"] = view_number(marker.grating->pitch_mm / seen.reference->view.mm_per_px(marker.grating->centre));
  const bool has_mm = seen.unit == BoardUnit::kMillimetre;
  for (const ExpectedUncertainty& expected : report.expected) {
    if (expected.marker != i || !has_mm) continue;
    view["u_dx_mm"] = view_number(expected.u.x);
    view["u_dy_mm"] = view_number(expected.u.y);
  }
  return view;
}

std::optional<BoardPoint> circle_centre(const Marker& marker) {
  if (marker.circle) return marker.circle->centre;
  if (marker.grating) return marker.grating->centre;
  return std::nullopt;
}

// Lists the distance for a tape first, then those of the other references from the first.
ViewJson distances_view(const Reference& reference) {
  const auto& markers = reference.site.markers;
  const ScaleCheck check = scale_check(reference);
  ViewJson list = ViewJson::array();
  if (check.from != check.to)
    list.push_back({{"from", markers[check.from].name}, {"to", markers[check.to].name}, {"mm", check.distance_mm}});
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const auto a = circle_centre(markers[check.from]), b = circle_centre(markers[i]);
    if (i == check.from || i == check.to || markers[i].role != Role::kReference || !a || !b) continue;
    list.push_back(
        {{"from", markers[check.from].name}, {"to", markers[i].name}, {"mm", std::hypot(a->x - b->x, a->y - b->y)}});
  }
  return list;
}

}  // namespace

NamedPositions named_positions(const Inspection& seen) {
  NamedPositions out;
  const auto add = [&](int marker, ImagePoint at) {
    if (marker != kUnidentified)
      out.emplace_back(seen.reference->site.markers[static_cast<std::size_t>(marker)].name, at);
  };
  for (const InspectedCircle& circle : seen.circles) add(circle.marker, circle.seen.centre);
  for (const InspectedPatch& patch : seen.patches) add(patch.marker, patch.seen.centre);
  return out;
}

ViewJson inspection_view(const InspectReport& report, const NamedPositions& ignored) {
  const Inspection& seen = report.seen;
  ViewJson json{{"frame", report.frame},         {"time_s", view_number(report.time_s)},
                {"frames", report.input.frames}, {"fps", view_number(report.input.fps)},
                {"codec", report.input.codec},   {"width", seen.width},
                {"height", seen.height}};
  ViewJson markers = ViewJson::array();
  for (std::size_t i = 0; seen.reference && i < seen.reference->site.markers.size(); ++i)
    markers.push_back(marker_view(report, i));
  for (const InspectedCircle& circle : seen.circles) {
    if (circle.marker == kUnidentified && circle.lattice == kUnidentified)
      markers.push_back(unidentified("circle", circle_view(circle.seen), circle.seen.centre, ignored));
  }
  for (const InspectedPatch& patch : seen.patches) {
    if (patch.marker == kUnidentified)
      markers.push_back(unidentified("grating", grating_view(patch), patch.seen.centre, ignored));
  }
  json["markers"] = std::move(markers);
  const bool has_mm = seen.reference && seen.unit == BoardUnit::kMillimetre;
  json["mm_per_px"] = has_mm ? view_number(scale_check(*seen.reference).mm_per_px) : ViewJson(nullptr);
  json["distances"] = has_mm ? distances_view(*seen.reference) : ViewJson::array();
  json["measurable"] = seen.reference.has_value();
  json["missing"] = seen.missing;
  json["warnings"] = seen.notes;
  json["exit_code"] = static_cast<int>(report.exit);
  return json;
}

}  // namespace moiregauge::internal
