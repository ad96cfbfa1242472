// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/plan_advice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Advice = std::optional<std::string>;

constexpr double kFinePitch_px = 8.0, kGoodFine_px = 12.0;  // binary prints lose their harmonics below the first
constexpr double kCoarsePitch_px = 40.0, kGoodCoarse_px = 20.0;
constexpr double kMaxBlur = 0.3;  // relative to the pitch: 14 % of the contrast
constexpr double kSamplesPerSwing = 2.5;
constexpr double kWorthIt = 0.8;  // largest remaining share of the uncertainty that makes a change worth its effort
constexpr double kLittleTurn_deg = 0.5;

struct Worst {
  double pitch_px = 0.0;
  std::string name;
};

template <typename Better>
Worst extreme_pitch(const RecordingSetup& setup, Better is_better) {
  Worst worst;
  for (const Marker& m : setup.site.markers) {
    if (!m.grating) continue;
    const double px = m.grating->pitch_mm * px_per_mm(setup, m.z_mm.value_or(0.0));
    if (worst.name.empty() || is_better(px, worst.pitch_px)) worst = {px, m.name};
  }
  return worst;
}

// Returns u of the worse axis of the worst target.
double worst_u(const RecordingSetup& setup) {
  double worst = 0.0;
  for (const PlannedTarget& t : planned_targets(setup)) {
    for (const double u : {t.u.x, t.u.y}) worst = std::isnan(u) ? worst : std::max(worst, u);
  }
  return worst;
}

RecordingSetup with_pitch(RecordingSetup setup, double factor) {
  for (Marker& m : setup.site.markers) {
    if (m.grating) m.grating->pitch_mm *= factor;
  }
  return setup;
}

Advice about_the_picture(const RecordingSetup& setup) {
  const TurningRoom room = turning_room(setup);
  if (room.pan < 0.0) {
    RecordingSetup other = setup;
    while (turning_room(other).pan < radians_from_degrees(kLittleTurn_deg) && other.distance_mm < 1e7)
      other.distance_mm *= 1.01;
    return fmt::format(
        "not all markers are in the image. Move back to {:.3g} m, or use a lens of {:.0f} % of this focal length",
        0.001 * other.distance_mm, 100.0 * setup.distance_mm / other.distance_mm);
  }
  const double least = degrees_from_radians(std::min({room.pan, room.tilt, room.roll}));
  if (least < kLittleTurn_deg)
    return fmt::format("a marker leaves the image after {:.2g} deg of rotation. Leave more space around the markers",
                       least);
  return std::nullopt;
}

Advice about_the_layout(const RecordingSetup& setup) {
  const auto better = better_layout(setup);
  const std::vector<PlannedTarget> targets = planned_targets(setup);
  if (!better) {
    for (const PlannedTarget& t : targets) {
      const double ratio = t.u.x / t.u.y;
      if (ratio > kWeakAxis || ratio < 1.0 / kWeakAxis)
        return fmt::format(
            "u_{} of '{}' is {:.1f} times u_{}, and the image has no space to move references. Move back, or rotate "
            "the camera by 90 deg",
            ratio > 1.0 ? "dx" : "dy", setup.site.markers[t.marker].name, std::max(ratio, 1.0 / ratio),
            ratio > 1.0 ? "dy" : "dx");
    }
    return std::nullopt;
  }
  const bool is_flat = better->by.y > 0.0;
  const double before = is_flat ? better->u_before.x : better->u_before.y,
               after = is_flat ? better->u_after.x : better->u_after.y;
  const double other = is_flat ? better->u_before.y : better->u_before.x;
  return fmt::format(
      "the references span only {:.2g} of their {} in {}, so u_{} of '{}' is {:.1f} times u_{}. Move {} {} by {:.2g} m "
      "(a span of {:.2g}) to get u_{} {} instead of {}{}",
      better->span_ratio_before, is_flat ? "width" : "height", is_flat ? "height" : "width", is_flat ? "dx" : "dy",
      setup.site.markers[better->target].name, before / other, is_flat ? "dy" : "dx", fmt::join(better->moved, " and "),
      is_flat ? "up" : "to the right", 0.001 * std::max(better->by.x, better->by.y), better->span_ratio_after,
      is_flat ? "dx" : "dy", length_text(after), length_text(before),
      better->picture_ends_it ? " (up to the image edge)" : "");
}

Advice about_the_pitch(const RecordingSetup& setup) {
  const Worst fine = extreme_pitch(setup, std::less<>());
  if (fine.pitch_px < kFinePitch_px) {
    const double factor = kGoodFine_px / fine.pitch_px;
    const double after = worst_u(with_pitch(setup, factor)), before = worst_u(setup);
    return fmt::format(
        "the pitch of '{}' is {:.1f} px in the image (8 to 30 px are good). With {:.1f} times the pitch, on gratings "
        "of this size, the largest u is {} instead of {}",
        fine.name, fine.pitch_px, factor, length_text(after), length_text(before));
  }
  const Worst coarse = extreme_pitch(setup, std::greater<>());
  if (coarse.pitch_px <= kCoarsePitch_px) return std::nullopt;
  const double factor = kGoodCoarse_px / coarse.pitch_px;
  const double after = worst_u(with_pitch(setup, factor)), before = worst_u(setup);
  if (!(after < kWorthIt * before)) return std::nullopt;
  return fmt::format(
      "the pitch of '{}' is {:.0f} px in the image. With {:.2g} times the pitch the largest u is {} instead of {}",
      coarse.name, coarse.pitch_px, factor, length_text(after), length_text(before));
}

Advice about_blur(const RecordingSetup& setup) {
  const PlannedBlur blur = planned_blur(setup);
  const double px = std::hypot(blur.target_px, blur.camera_px);
  const double pitch = extreme_pitch(setup, std::less<>()).pitch_px;
  if (!(px > kMaxBlur * pitch)) return std::nullopt;
  RecordingSetup shorter = setup;
  shorter.exposure_s *= kMaxBlur * pitch / px;
  return fmt::format(
      "the vibration blurs the image by {:.1f} px of a pitch of {:.1f} px{}. Expose for {:.2g} ms at most to get a "
      "largest u of {} instead of {}",
      px, pitch, px > 0.6 * pitch ? " (status blurred)" : "", 1000.0 * shorter.exposure_s,
      length_text(worst_u(shorter)), length_text(worst_u(setup)));
}

Advice about_time(const RecordingSetup& setup) {
  if (!setup.target_swing) return std::nullopt;
  const Swing& swing = *setup.target_swing;
  const double pitch = extreme_pitch(setup, std::less<>()).pitch_px / px_per_mm(setup);
  const double step =
      2.0 * swing.amplitude * std::abs(std::sin(std::min(0.5 * kPi, kPi * swing.frequency_hz / setup.fps)));
  if (setup.fps < kSamplesPerSwing * swing.frequency_hz)
    return fmt::format(
        "{:g} Hz at {:g} frames/s appears at another frequency (aliasing). Record {:.0f} frames/s or more",
        swing.frequency_hz, setup.fps, std::ceil(4.0 * swing.frequency_hz));
  if (step > 0.5 * pitch)
    return fmt::format(
        "the target moves {} per frame, more than half a pitch. Leave a white border around its grating, or record "
        "{:.0f} frames/s",
        length_text(step), std::ceil(kTwoPi * swing.frequency_hz * swing.amplitude / (0.5 * pitch)));
  return std::nullopt;
}

Advice about_the_shutter(const RecordingSetup& setup, bool readout_unknown) {
  if (readout_unknown)
    return "this camera has a rolling shutter. Give --readout (often 0.5 to 0.9 of 1 / fps) to see its effect";
  const ShutterError error = shutter_error(setup);
  const double mm = std::hypot(error.camera_mm, error.target_mm), u = worst_u(setup);
  if (!(mm > u)) return std::nullopt;
  return fmt::format(
      "the rolling shutter adds {}, more than u, because the references are read up to {:.2g} ms from the target. "
      "Mount references at the target's height, or rotate the camera by 90 deg",
      length_text(mm), 1000.0 * error.lag_s);
}

Advice about_checking(const RecordingSetup& setup) {
  const auto references = std::count_if(setup.site.markers.begin(), setup.site.markers.end(),
                                        [](const Marker& m) { return m.role == Role::kReference && m.grating; });
  if (references >= 6) return std::nullopt;
  return fmt::format("{} references cannot show which one moves. Use six references, which also lower u", references);
}

}  // namespace

std::string length_text(double mm) {
  if (!std::isfinite(mm)) return "not measured";
  const double um = 1000.0 * mm;
  if (um < 99.5) return fmt::format("{:.2g} um", um);
  if (mm < 0.995) return fmt::format("{:.0f} um", um);
  return fmt::format("{:.2g} mm", mm);
}

std::vector<std::string> advice_for(const RecordingSetup& setup, bool readout_unknown) {
  std::vector<std::string> lines;
  for (const Advice& line :
       {about_the_picture(setup), about_the_pitch(setup), about_blur(setup), about_time(setup), about_the_layout(setup),
        about_the_shutter(setup, readout_unknown), about_checking(setup)}) {
    if (line) lines.push_back(*line);
  }
  return lines;
}

}  // namespace moiregauge::internal
