// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/run_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "moiregauge/io/run_dir/solved_scene.h"
#include "moiregauge/observation/reference/scale_check.h"
#include "moiregauge/planning/layout_bound.h"
#include "moiregauge/units/units.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json input_json(const InputInfo& input, long seen) {
  return {{"path", input.path},
          {"sha256", input.sha256},
          {"frames", input.frames >= 0 ? input.frames : seen},
          {"width", input.width},
          {"height", input.height},
          {"bits", input.bits},
          {"fps", number(input.fps)},
          {"codec", input.codec},
          {"rotation_deg", input.rotation_deg},
          {"time_source", input.time_source},
          {"slow_motion", input.slow_motion},
          {"start_utc", input.start_utc.empty() ? Json(nullptr) : Json(input.start_utc)},
          {"tone", name_of(input.tone.curve)},
          {"tone_source", std::string(name_of(input.tone.source))}};
}

// States the frames. A range in seconds is also stated as typed; its frames are unknown if nothing was measured in it.
Json range_json(const FrameRange& range, const Observations& observations) {
  const auto frames = range.seconds ? in_frames(range, observations) : range;
  Json json{{"first", frames ? Json(frames->first) : Json(nullptr)},
            {"end", frames && frames->end >= 0 ? Json(frames->end) : Json(nullptr)},
            {"step", range.step}};
  if (!range.seconds) return json;
  json["first_s"] = range.seconds->first_s;
  json["end_s"] = number(range.seconds->end_s);
  return json;
}

Json choice_json(const MarkerChoice& choice) {
  Json names = Json::object();
  for (const NewName& name : choice.names) names[name.from] = name.to;
  return {
      {"references", choice.references}, {"targets", choice.targets}, {"ignored", choice.ignored}, {"names", names}};
}

Json channels_json(const std::vector<ChannelText>& channels) {
  Json out = Json::array();
  for (const ChannelText& channel : channels)
    out.push_back({{"name", channel.name},
                   {"unit", channel.unit.empty() ? Json(nullptr) : Json(channel.unit)},
                   {"expression", channel.expression}});
  return out;
}

Json area_json(const SearchArea& area) {
  const auto list = [](const std::vector<PixelRegion>& regions) {
    Json out = Json::array();
    for (const PixelRegion& r : regions) out.push_back({r.x, r.y, r.width, r.height});
    return out;
  };
  return {{"regions_px", list(area.regions)}, {"excluded_px", list(area.excluded)}};
}

Json config_json(const Measurement& measurement, const MeasureOptions& options) {
  const KnownTo& known_to = site_of(measurement, options).known_to;
  const auto range = [&](const FrameRange& typed) { return range_json(typed, measurement.observations); };
  Json config{{"frames", range(options.frames)},
              {"rest", options.solve.rest ? range(*options.solve.rest) : Json(nullptr)},
              {"zero", options.zero ? range(*options.zero) : Json(nullptr)},
              {"readout_s", options.solve.readout_s ? number(*options.solve.readout_s) : Json(nullptr)},
              {"reference_frame", nullptr},
              {"region_px", options.observe.raster.region_px},
              {"sampling_pitch_px", nullptr},
              {"min_circularity", options.observe.circles.min_circularity},
              {"known_to",
               {{"position_mm", known_to.position_mm},
                {"rotation_deg", degrees_from_radians(known_to.rotation_rad)},
                {"height_mm", known_to.height_mm},
                {"print_scale", known_to.print_scale}}}};
  config["pitch_mm"] = options.pitch_mm ? Json(*options.pitch_mm) : Json(nullptr);
  config["print_scale"] = {{"factor", options.print_scale.factor},
                           {"u", options.print_scale.u > 0.0 ? Json(options.print_scale.u) : Json(nullptr)}};
  config["axes"] = options.axes == BoardAxes::kPrint ? "print" : "image";
  config["tone"] = options.tone ? name_of(*options.tone) : "auto";
  config["choice"] = choice_json(options.choice);
  config["area"] = area_json(options.observe.area);
  config["channels"] = channels_json(options.channels);
  config["template"] = std::string(word_for(options.observe.template_use));
  if (options.reference_frame) config["reference_frame"] = *options.reference_frame;
  if (options.observe.raster.sampling_pitch_px > 0)
    config["sampling_pitch_px"] = options.observe.raster.sampling_pitch_px;
  return config;
}

// Returns the camera solved from the footage, or else the given one.
Json camera_json(const Measurement& measurement, std::optional<Camera> camera) {
  const std::optional<Scene>& scene = stated_scene(measurement);
  const bool solved = scene && determines_camera(*scene);
  if (solved) camera = scene->camera;
  Json json{
      {"model", camera ? "brown" : "none"}, {"width", measurement.input.width}, {"height", measurement.input.height}};
  const Camera c = camera.value_or(Camera{});
  const std::pair<const char*, double> keys[] = {{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy}, {"k1", c.k1},
                                                 {"k2", c.k2}, {"p1", c.p1}, {"p2", c.p2}, {"k3", c.k3}};
  for (const auto& [key, value] : keys) json[key] = camera ? Json(value) : Json(nullptr);
  json["u"] = Json::object();
  if (!solved) return json;
  const char* names[kCameraParameters] = {"fx", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  const auto u = u_of_camera(*scene);
  for (std::size_t k = 0; k < u.size(); ++k) {
    if (u[k] > 0.0) json["u"][names[k]] = number(u[k]);
  }
  return json;
}

Json scene_json(const Measurement& measurement) {
  if (!measurement.scene || !measurement.scene->solved)
    return {{"model", "homography"},  {"chi2_dof", nullptr},      {"key_frames", Json::array()}, {"readout_s", nullptr},
            {"u_readout_s", nullptr}, {"print_stretch", nullptr}, {"u_print_stretch", nullptr}};
  const Scene& scene = *measurement.scene;
  const auto stated = [&measurement](double value) { return stated_scene(measurement) ? number(value) : nullptr; };
  return {{"model", scene.model.name()},
          {"chi2_dof", number(scene.chi2_dof)},
          {"key_frames", scene.key_frames},
          {"readout_s", stated(scene.readout_s)},
          {"u_readout_s", stated(scene.u_readout_s)},
          {"print_stretch", stated(scene.stretch)},
          {"u_print_stretch", stated(std::sqrt(scene.stated_covariance()(kStretchParameter, kStretchParameter)))}};
}

// Returns a length that the user can check with a tape.
Json scale_json(const Measurement& measurement) {
  if (!measurement.reference) return nullptr;
  const ScaleCheck check = scale_check(*measurement.reference);
  const auto& markers = measurement.reference->site.markers;
  return {{"mm_per_px", number(check.mm_per_px)},
          {"from", markers[check.from].name},
          {"to", check.from == check.to ? Json(nullptr) : Json(markers[check.to].name)},
          {"distance_mm", number(check.distance_mm)}};
}

BoardPoint place_of(const Marker& marker) { return marker.grating ? marker.grating->centre : marker.circle->centre; }

// Adds the solved parameters of a marker, each with its u.
void add_solved(const Site& site, const Scene& scene, std::size_t i, Json& json) {
  const Marker solved = solved_marker(site, scene, i);
  const MarkerShape u = u_of_marker(scene, i);
  const auto add = [&](const char* key, double value, double of_it) {
    if (!(of_it > 0.0)) return;
    json[key] = number(value);
    json["u"][key] = number(of_it);
  };
  const BoardPoint at = place_of(solved);
  add("x_mm", at.x, u.value[MarkerShape::kX]);
  add("y_mm", at.y, u.value[MarkerShape::kY]);
  add("z_mm", scene.markers[i].value[MarkerShape::kHeight], u.value[MarkerShape::kHeight]);
  if (!solved.grating) return;
  add("angle_deg", degrees_from_radians(solved.grating->angle_rad),
      degrees_from_radians(u.value[MarkerShape::kRotation]));
  add("pitch_mm", solved.grating->pitch_mm, site.markers[i].grating->pitch_mm * u.value[MarkerShape::kScale]);
  for (const auto& [key, tilt] : {std::pair{"tilt_x_deg", MarkerShape::kTiltX}, {"tilt_y_deg", MarkerShape::kTiltY}})
    add(key, degrees_from_radians(scene.markers[i].value[tilt]), degrees_from_radians(u.value[tilt]));
}

Json measured_marker_json(const Measurement& measurement, const Site& site, std::size_t i) {
  const Marker& marker = site.markers[i];
  const BoardPoint at = place_of(marker);
  Json json{{"name", marker.name},
            {"role", marker.role == Role::kReference ? "reference" : "target"},
            {"x_mm", at.x},
            {"y_mm", at.y},
            {"z_mm", marker.z_mm ? Json(*marker.z_mm) : Json(nullptr)},
            {"angle_deg", marker.grating ? Json(degrees_from_radians(marker.grating->angle_rad)) : Json(nullptr)},
            {"pitch_mm", marker.grating ? Json(marker.grating->pitch_mm) : Json(nullptr)},
            {"pitch_px", nullptr},
            {"modulation", nullptr},
            {"u", Json::object()}};
  if (measurement.reference && marker.grating && i < measurement.reference->seen.markers.size()) {
    const Reference& reference = *measurement.reference;
    json["pitch_px"] = number(marker.grating->pitch_mm / reference.view.mm_per_px(at));
    const auto& modulation = reference.seen.markers[i].patch.modulation;
    // Grey levels as stored, also if light was measured.
    const double per_grey = i < reference.light_per_grey.size() ? reference.light_per_grey[i] : 1.0;
    json["modulation"] = number(std::fmax(modulation[0], modulation[1]) / per_grey);
  }
  if (const auto& scene = stated_scene(measurement)) add_solved(site, *scene, i, json);
  return json;
}

Json extent_json(const Extent<frame::Board>& e) { return {{"x_mm", number(e.x)}, {"y_mm", number(e.y)}}; }

Json budget_json(const Budget& budget) {
  Json json = Json::object();
  for (const BudgetPart& part : kBudgetParts) json[part.name] = extent_json(budget.*part.value);
  return json;
}

// Returns the Cramér-Rao bound of one frame, with all edges of the gratings. Only for `precise`.
Json bound_json(const Measurement& measurement, std::size_t target) {
  if (!measurement.reference || !measurement.scene) return nullptr;
  const auto bound = layout_bound(*measurement.reference, target, Bound::kFull);
  return {{"x", number(bound.x)}, {"y", number(bound.y)}};
}

// Returns frequency and damping of the vibration along one axis. Empty without a spectrum or a peak.
Json peaks_json(const AxisSpectrum& spectrum) {
  Json peaks = Json::array();
  for (const Peak& peak : spectrum.peaks)
    peaks.push_back({{"kind", word_for(peak.kind)},
                     {"frequency_hz", peak.frequency_hz},
                     {"amplitude_mm", peak.amplitude_mm},
                     {"damping", number(peak.damping)},
                     {"u", {{"frequency_hz", peak.u_frequency_hz}, {"damping", number(peak.u_damping)}}}});
  return peaks;
}

Json target_json(const Measurement& measurement, const Site& site, std::size_t k) {
  const TargetSummary& target = measurement.targets[k];
  return {{"name", site.markers[target.marker].name},
          {"frames", target.frames},
          {"ok", target.ok},
          {"status_counts", target.status_counts},
          {"u_dx_mm", number(target.u.x)},
          {"u_dy_mm", number(target.u.y)},
          {"bound_mm", bound_json(measurement, target.marker)},
          {"budget", budget_json(target.budget)},
          {"peaks", {{"x", peaks_json(measurement.spectra[k].x)}, {"y", peaks_json(measurement.spectra[k].y)}}}};
}

}  // namespace

nlohmann::ordered_json run_json(const Measurement& measurement, const MeasureOptions& options) {
  Json json{{"moiregauge", kVersion}, {"schema", kRunSchema}};
  json["input"] = input_json(measurement.input, static_cast<long>(measurement.observations.size()));
  json["config"] = config_json(measurement, options);
  json["method"] = std::string(options.method->name);
  json["reference_frame"] = measurement.reference ? Json(measurement.reference->seen.frame) : Json(nullptr);
  json["camera"] = camera_json(measurement, options.camera);
  json["markers"] = Json::array();
  const Site& site = site_of(measurement, options);
  for (std::size_t i = 0; i < site.markers.size(); ++i)
    json["markers"].push_back(measured_marker_json(measurement, site, i));
  json["scale"] = scale_json(measurement);
  json["scene"] = scene_json(measurement);
  json["targets"] = Json::array();
  for (std::size_t k = 0; k < measurement.targets.size(); ++k)
    json["targets"].push_back(target_json(measurement, site, k));
  json["references_verified"] = measurement.references_verified;
  json["warnings"] = measurement.warnings;
  json["exit_code"] = static_cast<int>(measurement.exit);
  json["complete"] = !measurement.interrupted && !measurement.input_damaged;
  return json;
}

}  // namespace moiregauge::internal
