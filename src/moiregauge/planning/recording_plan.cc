// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/planning/recording_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "moiregauge/observation/print/print_model.h"
#include "moiregauge/planning/codec_error.h"
#include "moiregauge/planning/reference_weights.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kRounding = 1.0 / 12.0;  // variance of rounding to whole grey levels, grey levels^2

struct Box {
  double low_x = 1e300, low_y = 1e300, high_x = -1e300, high_y = -1e300;
  void include(BoardPoint p, double half_x, double half_y) {
    low_x = std::min(low_x, p.x - half_x), high_x = std::max(high_x, p.x + half_x);
    low_y = std::min(low_y, p.y - half_y), high_y = std::max(high_y, p.y + half_y);
  }
  [[nodiscard]] BoardPoint middle() const { return {0.5 * (low_x + high_x), 0.5 * (low_y + high_y)}; }
};

void include(Box& box, const Marker& marker) {
  if (marker.circle)
    box.include(marker.circle->centre, 0.5 * marker.circle->diameter_mm, 0.5 * marker.circle->diameter_mm);
  if (marker.grating) {
    const Grating& g = *marker.grating;
    const double c = std::abs(std::cos(g.angle_rad)), s = std::abs(std::sin(g.angle_rad));
    box.include(g.centre, 0.5 * (c * g.width_mm + s * g.height_mm), 0.5 * (s * g.width_mm + c * g.height_mm));
  }
}

// Returns the part of a grating that is at least `clear_px` inside its edge, but at least a quarter of it.
Grating within(const RecordingSetup& setup, const Marker& marker, double clear_px) {
  Grating print = *marker.grating;
  const double clear_mm = 2.0 * clear_px / px_per_mm(setup, marker.z_mm.value_or(0.0));
  print.width_mm = std::max(print.width_mm - clear_mm, 0.5 * print.width_mm);
  print.height_mm = std::max(print.height_mm - clear_mm, 0.5 * print.height_mm);
  return print;
}

PrintTemplate print_planned(const RecordingSetup& setup, const Marker& marker, const Grating& print) {
  const double scale = px_per_mm(setup, marker.z_mm.value_or(0.0));
  const PlannedBlur blur = planned_blur(setup);
  PlannedOptics optics = setup.optics;
  // The direction of a swing is unknown, so it blurs both axes.
  optics.blur_x_px = optics.blur_y_px =
      marker.role == Role::kTarget ? std::hypot(blur.target_px, blur.camera_px) : blur.camera_px;
  return planned_print(print.pattern, print.pitch_mm * scale, optics);
}

double pixels_of_print(const RecordingSetup& setup, const Marker& marker, const Grating& print) {
  const double scale = px_per_mm(setup, marker.z_mm.value_or(0.0));
  return print.width_mm * print.height_mm * scale * scale;
}

Matrix2 information_planned(const RecordingSetup& setup, const Marker& marker, const Grating& print, Bound bound) {
  const double sigma = std::sqrt(setup.noise_sigma * setup.noise_sigma + kRounding);
  return shift_information(print, print_planned(setup, marker, print), pixels_of_print(setup, marker, print), sigma,
                           bound);
}

// Returns the codec's error of one grating along the board's axes, mm.
Extent<frame::Board> codec_of_print(const RecordingSetup& setup, const Marker& marker, const Quantiser& quantiser,
                                    Lag lag) {
  const Grating& print = *marker.grating;
  // Fisher information of one pixel with unit noise: the mean squared slope of the grey levels, 1/mm^2.
  const Matrix2 slopes = shift_information(print, print_planned(setup, marker, print), 1.0, 1.0, Bound::kFull);
  const double scale = px_per_mm(setup, marker.z_mm.value_or(0.0)), pixels = pixels_of_print(setup, marker, print);
  const auto along = [&](int axis) {
    return codec_u_px(quantiser, lag, std::sqrt(std::max(0.0, slopes(axis, axis))) / scale, pixels) / scale;
  };
  return {along(0), along(1)};
}

// Assume that the reference frame is the first of the recording: a key frame does not lag.
Extent<frame::Board> codec_of_target(const RecordingSetup& setup, std::size_t target) {
  const Quantiser &now = setup.codec, then{setup.codec.step, false};
  std::vector<BoardPoint> places;
  std::vector<Extent<frame::Board>> references;
  for (const Marker& marker : setup.site.markers) {
    if (marker.role != Role::kReference || !marker.grating) continue;
    places.push_back(marker.grating->centre);
    references.push_back(hypot3(codec_of_print(setup, marker, now, Lag::kShared),
                                codec_of_print(setup, marker, then, Lag::kShared), {}));
  }
  const Marker& marker = setup.site.markers[target];
  const auto through = through_references(reference_weights(places, marker.grating->centre), references);
  return hypot3(codec_of_print(setup, marker, now, Lag::kOwn), codec_of_print(setup, marker, then, Lag::kOwn), through);
}

// Divides a grating into parts, because each part shows its own position: one grating also shows rotation and stretch.
// The means of 8 x 8 parts lose 1/64 of that information.
void add_parts(std::vector<ReadPlace>& places, const Grating& print, const Matrix2& whole) {
  constexpr int kParts = 8;
  const double c = std::cos(print.angle_rad), s = std::sin(print.angle_rad);
  for (int j = 0; j < kParts; ++j) {
    for (int i = 0; i < kParts; ++i) {
      const double x = ((i + 0.5) / kParts - 0.5) * print.width_mm, y = ((j + 0.5) / kParts - 0.5) * print.height_mm;
      places.push_back({{print.centre.x + c * x - s * y, print.centre.y + s * x + c * y}, whole / (kParts * kParts)});
    }
  }
}

Extent<frame::Board> bound_of(const RecordingSetup& setup, std::size_t target, Bound bound, double clear_px = 0.0) {
  std::vector<ReadPlace> references;
  for (const Marker& marker : setup.site.markers) {
    if (marker.role != Role::kReference || !marker.grating) continue;
    const Grating part = within(setup, marker, clear_px);
    add_parts(references, part, information_planned(setup, marker, part, bound));
  }
  const Marker& marker = setup.site.markers[target];
  const auto through = through_homography(references, marker.grating->centre);
  if (!through) return {kUndetermined, kUndetermined};
  const Matrix2 own = information_planned(setup, marker, within(setup, marker, clear_px), bound);
  const bool shows_x = marker.grating->pattern != Pattern::kLinesY,
             shows_y = marker.grating->pattern != Pattern::kLinesX;
  if (shows_x && shows_y) {
    const Matrix2 variance = own.inverse() + *through;
    return {std::sqrt(variance(0, 0)), std::sqrt(variance(1, 1))};
  }
  return {shows_x ? std::sqrt(1.0 / own(0, 0) + (*through)(0, 0)) : kUndetermined,
          shows_y ? std::sqrt(1.0 / own(1, 1) + (*through)(1, 1)) : kUndetermined};
}

// Returns the largest angle to either side for which every corner stays in the image.
template <typename Turn>
double largest_turn(const std::vector<Eigen::Vector3d>& corners, const Camera& camera, double limit, Turn turn) {
  const auto holds = [&](double angle) {
    for (const double side : {-angle, angle}) {
      const Eigen::Matrix3d rotation = turn(side);
      for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d p = rotation * corner;
        if (!(p.z() > 0.0)) return false;
        const double u = camera.fx * p.x() / p.z() + camera.cx, v = camera.fy * p.y() / p.z() + camera.cy;
        if (u < 0.0 || v < 0.0 || u > camera.width - 1.0 || v > camera.height - 1.0) return false;
      }
    }
    return true;
  };
  if (!holds(0.0)) return -1.0;
  // A corner that leaves may return. The first angle counts, so search in steps of a degree.
  const double step = radians_from_degrees(1.0);
  double low = 0.0;
  while (low + step < limit && holds(low + step)) low += step;
  double high = std::min(low + step, limit);
  if (holds(high)) return high;
  for (int i = 0; i < 40; ++i) (holds(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

// Returns the corners of all markers in camera axes (x right, y down, z forward), with the markers' middle on the
// optical axis.
std::vector<Eigen::Vector3d> corners_before(const RecordingSetup& setup) {
  Box all;
  for (const Marker& marker : setup.site.markers) include(all, marker);
  const BoardPoint middle = all.middle();
  std::vector<Eigen::Vector3d> corners;
  for (const Marker& marker : setup.site.markers) {
    Box box;
    include(box, marker);
    for (const double x : {box.low_x, box.high_x}) {
      for (const double y : {box.low_y, box.high_y})
        corners.emplace_back(x - middle.x, middle.y - y, setup.distance_mm - marker.z_mm.value_or(0.0));
    }
  }
  return corners;
}

bool is_in_picture(const RecordingSetup& setup) { return turning_room(setup).pan >= 0.0; }

struct Sides {
  Box box;
  [[nodiscard]] double x() const { return box.high_x - box.low_x; }
  [[nodiscard]] double y() const { return box.high_y - box.low_y; }
  [[nodiscard]] double ratio() const { return std::min(x(), y()) / std::max(x(), y()); }
};

Sides span_of_references(const Site& site) {
  Sides sides;
  for (const Marker& m : site.markers) {
    if (m.role == Role::kReference && m.grating) sides.box.include(m.grating->centre, 0.0, 0.0);
  }
  return sides;
}

void move(Marker& marker, Extent<frame::Board> by) {
  if (marker.circle) marker.circle->centre = marker.circle->centre + by;
  if (marker.grating) marker.grating->centre = marker.grating->centre + by;
}

}  // namespace

double Swing::speed() const { return kTwoPi * frequency_hz * amplitude; }
double Swing::acceleration() const { return kTwoPi * frequency_hz * speed(); }

double px_per_mm(const RecordingSetup& setup, double z_mm) { return setup.camera.fx / (setup.distance_mm - z_mm); }

PlannedBlur planned_blur(const RecordingSetup& setup) {
  PlannedBlur blur;
  if (setup.target_swing) blur.target_px = setup.target_swing->speed() * setup.exposure_s * px_per_mm(setup);
  if (setup.camera_swing) blur.camera_px = setup.camera_swing->speed() * setup.exposure_s * setup.camera.fx;
  return blur;
}

std::vector<PlannedTarget> planned_targets(const RecordingSetup& setup) {
  std::vector<PlannedTarget> out;
  for (std::size_t i = 0; i < setup.site.markers.size(); ++i) {
    const Marker& marker = setup.site.markers[i];
    if (marker.role != Role::kTarget || !marker.grating) continue;
    const Extent<frame::Board> codec = setup.codec.is_lossless() ? Extent<frame::Board>{} : codec_of_target(setup, i);
    const double shutter = shutter_error(setup, i).camera_mm / std::sqrt(2.0);  // rms of a sine
    out.push_back({i, bound_of(setup, i, Bound::kPhase), bound_of(setup, i, Bound::kFull),
                   hypot3(std::sqrt(2.0) * bound_of(setup, i, Bound::kFull, kPrintEdgePx), codec, {shutter, shutter}),
                   codec, shutter});
  }
  return out;
}

ShutterError shutter_error(const RecordingSetup& setup, std::optional<std::size_t> only) {
  ShutterError error;
  const double row_s = setup.readout_s / std::max(1, setup.camera.height);
  for (std::size_t i = 0; i < setup.site.markers.size(); ++i) {
    const Marker& target = setup.site.markers[i];
    if (target.role != Role::kTarget || !target.grating || (only && *only != i)) continue;
    for (const Marker& reference : setup.site.markers) {
      if (reference.role != Role::kReference || !reference.grating) continue;
      const double rows = std::abs(target.grating->centre.y - reference.grating->centre.y) * px_per_mm(setup);
      error.lag_s = std::max(error.lag_s, rows * row_s);
    }
  }
  if (setup.camera_swing)
    error.camera_mm =
        0.5 * setup.camera_swing->acceleration() * error.lag_s * error.lag_s * setup.camera.fx / px_per_mm(setup);
  if (setup.target_swing) error.target_mm = setup.target_swing->speed() * error.lag_s;
  return error;
}

TurningRoom turning_room(const RecordingSetup& setup) {
  const auto corners = corners_before(setup);
  const auto about = [&](const Eigen::Vector3d& axis, double limit) {
    return largest_turn(corners, setup.camera, limit, [&](double angle) -> Eigen::Matrix3d {
      return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    });
  };
  return {about(Eigen::Vector3d::UnitY(), 0.49 * kPi), about(Eigen::Vector3d::UnitX(), 0.49 * kPi),
          about(Eigen::Vector3d::UnitZ(), kPi)};
}

std::optional<BetterLayout> better_layout(const RecordingSetup& setup) {
  constexpr double kGoodSpan = 0.3;  // short side by long side: beyond it the weak axis gains little; chosen
  constexpr double kWorthIt = 0.8;   // least gain: the remaining share of u must be below this; chosen
  BetterLayout found;
  double worst = kWeakAxis;
  for (const PlannedTarget& target : planned_targets(setup)) {
    const double ratio = std::max(target.u.x / target.u.y, target.u.y / target.u.x);
    if (ratio > worst) worst = ratio, found.target = target.marker, found.u_before = target.u;
  }
  if (worst == kWeakAxis) return std::nullopt;
  const Sides before = span_of_references(setup.site);
  const bool is_flat = before.y() < before.x();
  const double middle = is_flat ? before.box.middle().y : before.box.middle().x;
  const double needed = kGoodSpan * std::max(before.x(), before.y()) - std::min(before.x(), before.y());
  const auto moved_by = [&](double mm, std::vector<std::string>* names) {
    RecordingSetup other = setup;
    for (Marker& m : other.site.markers) {
      if (m.role != Role::kReference || !m.grating) continue;
      if ((is_flat ? m.grating->centre.y : m.grating->centre.x) <= middle) continue;
      move(m, is_flat ? Extent<frame::Board>{0.0, mm} : Extent<frame::Board>{mm, 0.0});
      if (names != nullptr) names->push_back(m.name);
    }
    return other;
  };
  double mm = 10.0 * std::ceil(0.1 * needed);
  while (mm > 0.0 && !is_in_picture(moved_by(mm, nullptr))) mm -= 10.0, found.picture_ends_it = true;
  if (!(mm > 0.0)) return std::nullopt;
  const RecordingSetup other = moved_by(mm, &found.moved);
  found.by = is_flat ? Extent<frame::Board>{0.0, mm} : Extent<frame::Board>{mm, 0.0};
  found.span_ratio_before = before.ratio();
  found.span_ratio_after = span_of_references(other.site).ratio();
  for (const PlannedTarget& target : planned_targets(other)) {
    if (target.marker == found.target) found.u_after = target.u;
  }
  const bool x_is_weak = found.u_before.x > found.u_before.y;
  const double left = x_is_weak ? found.u_after.x / found.u_before.x : found.u_after.y / found.u_before.y;
  if (!(left < kWorthIt)) return std::nullopt;
  return found;
}

}  // namespace moiregauge::internal
