// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/views/reprojection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/reference/site_check.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using BoardExtent = Extent<frame::Board>;
constexpr double kProbe_mm = 1.0;  // half distance over which the change of scale is computed

std::string text_about(const char* format, const std::string& name, double a = 0.0, double b = 0.0) {
  char text[240];
  std::snprintf(text, sizeof text, format, name.c_str(), a, b);
  return text;
}

// Returns the new site with its markers in the order of the old one. Markers may differ in positions, angles and
// heights, and slightly in pitch.
// Fails: a marker is missing, new or has another role.
tl::expected<Site, std::string> in_old_order(const Site& then, const Site& now) {
  const auto same = [](const Marker& a, const Marker& b) { return a.name == b.name && a.role == b.role; };
  for (const Marker& m : now.markers) {
    if (std::none_of(then.markers.begin(), then.markers.end(), [&](const Marker& was) { return same(was, m); }))
      return tl::unexpected(text_about("marker '%s' was not measured, or not in this role", m.name));
  }
  Site ordered{{}, now.known_to};
  for (const Marker& was : then.markers) {
    const auto is = std::find_if(now.markers.begin(), now.markers.end(), [&](const Marker& m) { return same(was, m); });
    if (is == now.markers.end()) return tl::unexpected(text_about("marker '%s' is missing", was.name));
    ordered.markers.push_back(*is);
  }
  return ordered;
}

std::optional<std::string> other_print(const Marker& was, const Marker& is) {
  if (is.circle.has_value() != was.circle.has_value() || is.grating.has_value() != was.grating.has_value())
    return text_about("marker '%s' must have the circle and grating it was measured with", is.name);
  if (!is.grating) return std::nullopt;
  if (is.grating->pattern != was.grating->pattern)
    return text_about("marker '%s' was measured with another pattern", is.name);
  const double pitch = is.grating->pitch_mm, before = was.grating->pitch_mm;
  if (std::abs(pitch / before - 1.0) > kRestatedPitch)
    return text_about("marker '%s' has pitch_mm = %.4g, but was measured with %.4g", is.name, pitch, before);
  const double turn = degrees_from_radians(wrapped(is.grating->angle_rad - was.grating->angle_rad));
  if (std::abs(turn) > kRestatedAngle_deg)
    return text_about("marker '%s' has an angle_deg that differs by %+.3g from the measurement, and %.3g is the limit",
                      is.name, turn, kRestatedAngle_deg);
  return std::nullopt;
}

// Returns the circle points of one frame, for the new site and lens.
std::vector<CirclePoint> points_of(const Site& site, const Camera& lens, const Observation& seen) {
  CircleSearch search;
  Identified who;
  who.circle_of_marker.assign(site.markers.size(), -1);
  who.image_from_board = Homography<frame::Image, frame::Board>(seen.stage1.matrix());
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    if (!seen.markers[i].circle || !site.markers[i].circle) continue;
    who.circle_of_marker[i] = static_cast<int>(search.circles.size());
    search.circles.push_back(*seen.markers[i].circle);
  }
  return circle_points(site, lens, search, who);
}

// Position of a new window in the board coordinates of the old run.
struct Carried {
  BoardExtent off;  // mm, from the middle of the old window
  Matrix2 change;   // d(old board) / d(new board)
};

Carried carried(const View& then, const View& now, BoardPoint old_middle, BoardPoint new_middle) {
  const auto old_place = [&](double dx, double dy) { return then.board(now(new_middle + BoardExtent{dx, dy})); };
  const auto along_x = old_place(kProbe_mm, 0) - old_place(-kProbe_mm, 0);
  const auto along_y = old_place(0, kProbe_mm) - old_place(0, -kProbe_mm);
  Matrix2 change;
  change << along_x.x, along_y.x, along_x.y, along_y.y;
  return {old_place(0, 0) - old_middle, change / (2.0 * kProbe_mm)};
}

Matrix2 board_from_raster_axes(const RasterPlan& plan) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return (Matrix2() << c, -s, s, c).finished();
}

// Converts phase and gradient to the new middle, axes and pitch. With u the grating's apparent displacement along
// raster axis a, phase_a = 2 pi (x_a - u_a(x)) / pitch.
void carry(PatchReading& patch, const RasterPlan& then, const RasterPlan& now, const Carried& to) {
  const auto e = raster_from_board(then, to.off);
  const Matrix2 change = board_from_raster_axes(then).transpose() * to.change * board_from_raster_axes(now);
  for (std::size_t a = 0; a < 2; ++a) {
    auto& g = patch.gradient[a];
    const double lag = std::isfinite(g[0]) && std::isfinite(g[1]) ? g[0] * e[0] + g[1] * e[1] : 0.0;
    patch.phase_rad[a] = wrapped(patch.phase_rad[a] + kTwoPi * (e[a] - lag) / then.pitch_mm);
    const Eigen::RowVector2d row((a == 0 ? 1.0 : 0.0) - g[0], (a == 1 ? 1.0 : 0.0) - g[1]);
    const Eigen::RowVector2d turned = now.pitch_mm / then.pitch_mm * row * change;
    g = {(a == 0 ? 1.0 : 0.0) - turned(0), (a == 1 ? 1.0 : 0.0) - turned(1)};
  }
}

class Restating {
 public:
  Restating(const Reference& then, const Site& site, const Camera& lens) : then_(then), now_(then) {
    now_.site = site;
    now_.lens = lens;
  }

  std::optional<std::string> reference_frame() {
    now_.circles = points_of(now_.site, now_.lens, then_.seen);
    const auto h = fit_circles(now_.circles);
    if (!h) return "the reference circles do not determine the view, so give four that are not on one line";
    now_.view = {*h, now_.lens};
    now_.seen.stage1 = now_.seen.stage2 = *h;
    for (std::size_t i = 0; i < now_.site.markers.size(); ++i) {
      if (!now_.site.markers[i].grating) continue;
      if (auto problem = plan(i)) return problem;
      carry_marker(i, then_.view, now_.view, now_.seen.markers[i]);
    }
    return site_disagreement(now_);
  }

  [[nodiscard]] Observation frame(const Observation& then) const {
    Observation now = then;
    if (!then.references_seen) return now;
    const auto points = points_of(now_.site, now_.lens, then);
    const auto first = fit_circles(points);
    if (!first && !points.empty() && !now_.knows_camera()) {
      now.references_seen = false;
      now.reference_problem = "fewer than four of the chosen reference circles are visible";
      return now;
    }
    // A method that assumes a fixed camera detects no circles.
    now.stage1 = now.stage2 = first ? *first : now_.seen.stage1;
    carry_role(Role::kReference, then, now);
    if (first) {
      const auto second = second_view(now_, points, now);
      now.references_seen = second.has_value();
      if (second) now.stage2 = *second;
    }
    carry_role(Role::kTarget, then, now);
    return now;
  }
  [[nodiscard]] const Reference& reference() const { return now_; }

 private:
  // Plans the raster of a marker in the same pixels, with the new millimetres.
  std::optional<std::string> plan(std::size_t i) {
    const Grating& was = *then_.site.markers[i].grating;
    const Grating& is = *now_.site.markers[i].grating;
    RasterPlan& plan = now_.plans[i];
    const double scale = is.pitch_mm / was.pitch_mm;
    plan.centre = is.centre;
    plan.angle_rad += is.angle_rad - was.angle_rad;
    for (double* length : {&plan.pitch_mm, &plan.step_mm, &plan.clearance_mm}) *length *= scale;
    const BoardExtent off = then_.view.board(now_.view(is.centre)) - was.centre;
    // Grating coordinate of the new zero in the old template, pitches.
    const auto zero = print_from_board(was, {})(was.centre + off);
    zero_.resize(now_.site.markers.size());
    zero_[i] = {zero.x, zero.y};
    const double most = kRestatedPlace * std::min(was.width_mm, was.height_mm);
    if (!(length(off) <= most))
      return text_about("the grating of marker '%s' was measured %.3g mm from its position in this site",
                        now_.site.markers[i].name, length(off));
    return std::nullopt;
  }

  void carry_role(Role role, const Observation& then, Observation& now) const {
    const View after{role == Role::kReference ? now.stage1 : now.stage2, now_.lens};
    for (std::size_t i = 0; i < now.markers.size(); ++i) {
      if (!now_.site.markers[i].grating || now_.site.markers[i].role != role) continue;
      const bool was_reference = then_.site.markers[i].role == Role::kReference;
      carry_marker(i, {was_reference ? then.stage1 : then.stage2, then_.lens}, after, now.markers[i]);
    }
  }

  void carry_marker(std::size_t i, const View& before, const View& after, MarkerObservation& seen) const {
    if (seen.points) {
      for (PrintPoint& p : seen.points->print) p = {p.x - zero_[i].x, p.y - zero_[i].y};
    }
    if (then_.plans[i].pitch_mm <= 0.0 || !seen.patch.valid) return;
    const BoardExtent shift = seen.window_shift;
    carry(seen.patch, then_.plans[i], now_.plans[i],
          carried(before, after, then_.plans[i].centre + shift, now_.plans[i].centre + shift));
  }

  const Reference& then_;
  Reference now_;
  // By marker: position of the new site's zero in the old template, pitches.
  std::vector<PrintPoint> zero_;
};

}  // namespace

namespace {

template <typename Value>
std::vector<Value> part_of(const std::vector<Value>& all, const std::vector<std::size_t>& from) {
  std::vector<Value> part;
  part.reserve(from.size());
  for (const std::size_t i : from) part.push_back(all[i]);
  return part;
}

// Returns the reference frame with these markers only, in their old roles.
Reference reduced(const Reference& reference, const std::vector<std::size_t>& from) {
  Reference out = reference;
  out.site.markers = part_of(reference.site.markers, from);
  out.plans = part_of(reference.plans, from);
  out.plan_loss = part_of(reference.plan_loss, from);
  out.seen.markers = part_of(reference.seen.markers, from);
  if (!reference.prints.empty()) out.prints = part_of(reference.prints, from);
  if (!reference.light_per_grey.empty()) out.light_per_grey = part_of(reference.light_per_grey, from);
  out.circles.clear();
  for (const CirclePoint& point : reference.circles) {
    const auto found = std::find(from.begin(), from.end(), point.marker);
    if (found == from.end()) continue;
    out.circles.push_back(point);
    out.circles.back().marker = static_cast<std::size_t>(found - from.begin());
  }
  return out;
}

// A reference is read through its circle, or by `precise` through its template.
std::optional<std::string> missing_readings(const Reference& then, const Site& chosen, const Observations& frames) {
  for (std::size_t i = 0; i < chosen.markers.size(); ++i) {
    if (chosen.markers[i].role != Role::kReference || then.site.markers[i].role == Role::kReference) continue;
    if (then.seen.markers[i].points) continue;
    const bool has_circles = std::all_of(frames.begin(), frames.end(), [i](const Observation& seen) {
      return !seen.references_seen || seen.markers[i].circle.has_value();
    });
    if (!has_circles)
      return text_about("target '%s' cannot become a reference, because its circle was not read in every frame",
                        then.site.markers[i].name);
  }
  return std::nullopt;
}

}  // namespace

tl::expected<Reprojected, std::string> select_markers(const Reference& reference, const Observations& observations,
                                                      const Site& chosen, const std::vector<std::size_t>& from) {
  const Reference then = reduced(reference, from);
  Observations reduced_frames(then);
  for (Observation seen : observations) {
    seen.markers = part_of(seen.markers, from);
    reduced_frames.push_back(seen);
  }
  if (auto problem = missing_readings(then, chosen, reduced_frames)) return tl::unexpected(*std::move(problem));
  Restating restating(then, chosen, reference.lens);
  if (auto problem = restating.reference_frame()) return tl::unexpected(*std::move(problem));
  Reprojected out{restating.reference(), Observations(restating.reference())};
  for (const Observation& seen : reduced_frames) out.observations.push_back(restating.frame(seen));
  return out;
}

tl::expected<Reprojected, std::string> reproject_observations(const Reference& reference,
                                                              const Observations& observations, const Site& site,
                                                              const Camera& lens) {
  auto ordered = in_old_order(reference.site, site);
  if (!ordered) return tl::unexpected(ordered.error());
  for (std::size_t i = 0; i < ordered->markers.size(); ++i) {
    if (auto problem = other_print(reference.site.markers[i], ordered->markers[i])) return tl::unexpected(*problem);
  }
  Restating restating(reference, *ordered, lens);
  if (auto problem = restating.reference_frame()) return tl::unexpected(*problem);
  Reprojected out{restating.reference(), Observations(restating.reference())};
  for (const Observation& seen : observations) out.observations.push_back(restating.frame(seen));
  return out;
}

}  // namespace moiregauge::internal
