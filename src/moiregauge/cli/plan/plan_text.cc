// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/plan_text.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/app/plan_advice.h"
#include "moiregauge/cli/plan/print_text.h"
#include "moiregauge/units/units.h"
#include "moiregauge/version.h"

namespace moiregauge::internal::cli {
namespace {

constexpr std::size_t kLabel = 12, kWidth = 100;

// Formats a label and its sentence, with line breaks between words.
std::string line(const std::string& label, const std::string& words) {
  std::string text = fmt::format("{:<{}}", label, kLabel), rest = words;
  while (rest.size() > kWidth) {
    auto cut = rest.rfind(' ', kWidth);
    if (cut == std::string::npos) break;
    text += rest.substr(0, cut) + "\n" + std::string(kLabel, ' ');
    rest.erase(0, cut + 1);
  }
  return text + rest + "\n";
}

struct Range {
  double low = 1e300, high = 0.0;
  void include(double v) { low = std::min(low, v), high = std::max(high, v); }
  [[nodiscard]] std::string words(const char* unit) const {
    return high - low < 0.005 * high ? fmt::format("{:.3g} {}", high, unit)
                                     : fmt::format("{:.3g} to {:.3g} {}", low, high, unit);
  }
};

std::string camera_text(const PlanOrder& order) {
  const Camera& c = order.setup.camera;
  const double fov = 2.0 * degrees_from_radians(std::atan(0.5 * c.width / c.fx));
  return fmt::format("{}{} x {} px, f = {:.0f} px ({:.3g} deg across){}",
                     order.camera_name.empty() ? "" : order.camera_name + ": ", c.width, c.height, c.fx, fov,
                     order.camera_source.empty() ? "" : "; source: " + order.camera_source);
}

std::string scale_text(const RecordingSetup& s) {
  const double scale = px_per_mm(s);
  return fmt::format("{:.3g} mm/px at {:.3g} m; field of view {:.3g} x {:.3g} m", 1.0 / scale, 0.001 * s.distance_mm,
                     0.001 * s.camera.width / scale, 0.001 * s.camera.height / scale);
}

std::string print_text(const RecordingSetup& s) {
  Range mm, px;
  int references = 0, targets = 0;
  for (const Marker& m : s.site.markers) {
    (m.role == Role::kReference ? references : targets) += 1;
    if (!m.grating) continue;
    mm.include(m.grating->pitch_mm);
    px.include(m.grating->pitch_mm * px_per_mm(s, m.z_mm.value_or(0.0)));
  }
  return fmt::format("{} references, {} target{}; pitch {} = {} (8 to 30 px are good)", references, targets,
                     targets == 1 ? "" : "s", mm.words("mm"), px.words("px"));
}

std::string codec_text(const RecordingSetup& s) {
  double worst = 0.0;
  for (const PlannedTarget& t : planned_targets(s)) worst = std::fmax(worst, std::fmax(t.codec.x, t.codec.y));
  return fmt::format(
      "compression causes {} of u (typical quantisation step, {:.3g} grey levels). Record raw or lossless (--lossless) "
      "to avoid this",
      length_text(worst), s.codec.step);
}

std::string blur_text(const RecordingSetup& s) {
  const PlannedBlur blur = planned_blur(s);
  if (!s.target_swing && !s.camera_swing)
    return fmt::format("unknown (exposure {:.3g} ms); give --vibration 0.5mm@5Hz or --camera-vibration 0.01deg@10Hz",
                       1000.0 * s.exposure_s);
  std::string words;
  if (s.target_swing) words += fmt::format("{:.2g} px by the target's vibration", blur.target_px);
  if (s.camera_swing)
    words += fmt::format("{}{:.2g} px by the camera's vibration", s.target_swing ? ", " : "", blur.camera_px);
  return words + fmt::format(", at its fastest (exposure {:.3g} ms)", 1000.0 * s.exposure_s);
}

std::string motion_text(const RecordingSetup& s) {
  double pitch = 1e300;
  for (const Marker& m : s.site.markers) {
    if (m.grating && m.role == Role::kTarget) pitch = std::min(pitch, m.grating->pitch_mm);
  }
  return fmt::format(
      "up to half a pitch, {:.3g} mm, per frame ({:.3g} mm/s at {:g} frames/s); more if the grating's edge is visible",
      0.5 * pitch, 0.5 * pitch * s.fps, s.fps);
}

std::string shutter_text(const PlanOrder& order) {
  const RecordingSetup& s = order.setup;
  if (order.readout_unknown) return "rolling, readout time unknown: give --readout";
  if (!(s.readout_s > 0.0)) return "global, all image rows at once";
  const ShutterError e = shutter_error(s);
  std::string words = fmt::format("rolling, up to {:.3g} ms between target and references", 1000.0 * e.lag_s);
  if (s.camera_swing)
    words += fmt::format("; in that time the camera's vibration adds up to {}, and {} to u", length_text(e.camera_mm),
                         length_text(e.camera_mm / std::sqrt(2.0)));
  if (s.target_swing) words += fmt::format("; the target moves {} in that time", length_text(e.target_mm));
  return words;
}

std::string rotation_text(const RecordingSetup& s) {
  const TurningRoom room = turning_room(s);
  if (room.pan < 0.0) return "none: a marker is outside the image";
  return fmt::format(
      "the camera may pan by {:.2g}, tilt by {:.2g} and roll by {:.2g} deg before a marker leaves the image",
      degrees_from_radians(room.pan), degrees_from_radians(room.tilt), degrees_from_radians(room.roll));
}

// Returns the parts of u that are not zero.
std::string parts_of_u(const RecordingSetup& s) {
  const bool has_shutter = shutter_error(s).camera_mm > 0.0, has_codec = !s.codec.is_lossless();
  if (has_codec && has_shutter) return "noise, codec and rolling shutter";
  return has_codec ? "noise and codec" : has_shutter ? "noise and rolling shutter" : "noise only";
}

std::string uncertainty_table(const RecordingSetup& s) {
  const auto row = [](const std::string& label, const std::string& name, const std::array<std::string, 6>& cells) {
    return fmt::format("{:<{}}{:<12} {:>9} {:>9}   {:>9} {:>9}   {:>9} {:>9}\n", label, kLabel, name, cells[0],
                       cells[1], cells[2], cells[3], cells[4], cells[5]);
  };
  std::string text = row("u (k = 1)", "of", {"dx", "dy", "bound dx", "dy", "phase dx", "dy"});
  for (const PlannedTarget& t : planned_targets(s))
    text += row("", s.site.markers[t.marker].name,
                {length_text(t.u.x), length_text(t.u.y), length_text(t.full_bound.x), length_text(t.full_bound.y),
                 length_text(t.phase_bound.x), length_text(t.phase_bound.y)});
  return text +
         line("", fmt::format("dx, dy: plan with these ({}, between two frames). bound, phase: theoretical limits of "
                              "one frame, for experts",
                              parts_of_u(s)));
}

using Json = nlohmann::ordered_json;

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }
Json pair(Extent<frame::Board> e) { return {{"x", number(e.x)}, {"y", number(e.y)}}; }

}  // namespace

std::string plan_text(const PlanOrder& order) {
  const RecordingSetup& s = order.setup;
  std::string text = line("camera", camera_text(order)) + line("scale", scale_text(s)) +
                     line("pitch", pitch_text(order)) + line("markers", print_text(s)) +
                     line("paper", paper_text(order));
  if (!order.layout_note.empty()) text += line("note", order.layout_note);
  text += uncertainty_table(s);
  text += line(
      "on top",
      fmt::format("{:.2g} % of the displacement for the print scale, less once you measure the rulers (--print-scale). "
                  "Lens and position errors are added during measurement",
                  100.0 * s.site.known_to.print_scale));
  if (!s.codec.is_lossless()) text += line("codec", codec_text(s));
  text += line("blur", blur_text(s)) + line("motion", motion_text(s)) + line("shutter", shutter_text(order)) +
          line("turns", rotation_text(s));
  const auto advice = advice_for(s, order.readout_unknown);
  for (const std::string& words : advice) text += line("advice", words);
  if (advice.empty()) text += line("advice", "none: the set-up is ready to film");
  return text;
}

std::string plan_json(const PlanOrder& order) {
  const RecordingSetup& s = order.setup;
  const Camera& c = s.camera;
  const PlannedBlur blur = planned_blur(s);
  const ShutterError shutter = shutter_error(s);
  const TurningRoom room = turning_room(s);
  Json targets = Json::array(), markers = Json::array();
  for (const PlannedTarget& t : planned_targets(s))
    targets.push_back({{"name", s.site.markers[t.marker].name},
                       {"u_mm", pair(t.u)},
                       {"codec_mm", pair(t.codec)},
                       {"shutter_mm", number(t.shutter)},
                       {"bound_mm", pair(t.full_bound)},
                       {"phase_bound_mm", pair(t.phase_bound)}});
  for (const Marker& m : s.site.markers) {
    if (!m.grating) continue;
    markers.push_back({{"name", m.name},
                       {"role", m.role == Role::kReference ? "reference" : "target"},
                       {"x_mm", m.grating->centre.x},
                       {"y_mm", m.grating->centre.y},
                       {"pitch_px", m.grating->pitch_mm * px_per_mm(s, m.z_mm.value_or(0.0))}});
  }
  const PaperNeed need = paper_need(s.site);
  const Json json{
      {"moiregauge", kVersion},
      {"schema", 1},
      {"camera",
       {{"name", order.camera_name},
        {"width", c.width},
        {"height", c.height},
        {"f_px", c.fx},
        {"source", order.camera_source}}},
      {"distance_mm", s.distance_mm},
      {"mm_per_px", 1.0 / px_per_mm(s)},
      {"noise", s.noise_sigma},
      {"contrast", s.optics.contrast},
      {"psf_px", s.optics.psf_sigma_px},
      {"fps", s.fps},
      {"exposure_s", s.exposure_s},
      {"codec_step", s.codec.step},
      {"readout_s", order.readout_unknown ? Json(nullptr) : Json(s.readout_s)},
      {"good_pitch_mm", {kFinestGoodPitch_px / px_per_mm(s), kCoarsestGoodPitch_px / px_per_mm(s)}},
      {"print",
       {{"paper", need.paper.empty() ? Json(nullptr) : Json(need.paper)},
        {"sheets", need.sheets},
        {"a4_pages", need.a4_parts},
        {"command", sheet_command(order, need.paper.empty() ? "A4" : need.paper)}}},
      {"markers", markers},
      {"targets", targets},
      {"u_print_scale", s.site.known_to.print_scale},
      {"blur_px", {{"target", blur.target_px}, {"camera", blur.camera_px}}},
      {"shutter", {{"lag_s", shutter.lag_s}, {"camera_mm", shutter.camera_mm}, {"target_mm", shutter.target_mm}}},
      {"turns_deg",
       {{"pan", degrees_from_radians(room.pan)},
        {"tilt", degrees_from_radians(room.tilt)},
        {"roll", degrees_from_radians(room.roll)}}},
      {"in_picture", room.pan >= 0.0},
      {"advice", advice_for(s, order.readout_unknown)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal::cli
