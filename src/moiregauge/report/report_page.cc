// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/report_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "moiregauge/report/packed_columns.h"
#include "moiregauge/report/page_picture.h"
#include "moiregauge/report/page_scripts.h"
#include "moiregauge/report/report_text.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using Json = nlohmann::ordered_json;

// Quantum of plotted values in u: its rounding error is at most 1.4 % of u (rms).
constexpr double kPartOfU = 0.05;
constexpr double kMinQuantum = 1e-7;      // mm
constexpr double kUnknownQuantum = 1e-5;  // mm, without u
constexpr double kTimeQuantum = 1e-6;     // s
constexpr double kPixelQuantum = 1e-3;
constexpr double kDegreeQuantum = 1e-5;
constexpr double kShareQuantum = 1e-4;   // for modulation ratio and chi-squared
constexpr double kDecadeQuantum = 1e-3;  // for a spectrum, in decades

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json spectrum_json(const AxisSpectrum& s, PackedColumns& columns) {
  if (!s.refusal.empty()) return {{"refusal", s.refusal}};
  std::vector<double> decades;
  for (const double psd : s.spectrum.psd) decades.push_back(psd > 0.0 ? std::log10(psd) : kNotMeasured);
  Json peaks = Json::array();
  for (const Peak& p : s.peaks) {
    peaks.push_back({{"kind", word_for(p.kind)},
                     {"frequency_hz", p.frequency_hz},
                     {"u_frequency_hz", p.u_frequency_hz},
                     {"amplitude_mm", p.amplitude_mm},
                     {"damping", number(p.damping)},
                     {"u_damping", number(p.u_damping)},
                     {"no_damping", p.no_damping},
                     {"from_s", p.from_s},
                     {"to_s", p.to_s}});
  }
  return {{"step_hz", s.spectrum.frequency_hz[1]},
          {"log10_psd", columns.add(decades, kDecadeQuantum)},
          {"resolution_hz", s.spectrum.resolution_hz},
          {"segments", s.spectrum.segments},
          {"segment_s", static_cast<double>(s.spectrum.segment_samples) * s.interval_s},
          {"samples", s.spectrum.samples},
          {"gaps", s.gaps},
          {"longest_s", s.longest_s},
          {"interval_s", s.interval_s},
          {"peaks", std::move(peaks)}};
}

// Returns the samples of one target as columns, one value per observation.
Json rows_json(const Measurement& m, const TargetSummary& target, PackedColumns& columns) {
  std::vector<double> dx, dy, ux, uy, status;
  for (const Sample& s : m.samples) {
    if (s.marker != target.marker) continue;
    dx.push_back(s.displacement.x);
    dy.push_back(s.displacement.y);
    ux.push_back(s.u.x);
    uy.push_back(s.u.y);
    status.push_back(status_code(s.status));
  }
  const double least_u = std::fmin(target.u.x, target.u.y);
  const double quantum = std::isnan(least_u) ? kUnknownQuantum : decade_below(kPartOfU * least_u, kMinQuantum);
  return {{"dx", columns.add(dx, quantum)},
          {"dy", columns.add(dy, quantum)},
          {"ux", columns.add(ux, quantum)},
          {"uy", columns.add(uy, quantum)},
          {"status", columns.add(status, 1.0)}};
}

// Columns are rounded to a part of u. The last digit of a difference of two values is correct without that rounding only.
Json extent_json(const Extent<frame::Board>& e) { return {{"dx", number(e.x)}, {"dy", number(e.y)}}; }

// Changes the sign: the camera's rotation is the opposite of the board's.
std::vector<double> other_way(std::vector<double> values) {
  for (double& value : values) value = -value;
  return values;
}

Json camera_json(const CameraMotion& camera, PackedColumns& columns) {
  Json json{{"right", columns.add(camera.shift_x_px, kPixelQuantum)},
            {"down", columns.add(camera.shift_y_px, kPixelQuantum)}};
  const bool knows_turn = !camera.turn_x_deg.empty();
  const auto turn = [&](const std::vector<double>& of_board) {
    return knows_turn ? Json(columns.add(other_way(of_board), kDegreeQuantum)) : Json(nullptr);
  };
  json["pan"] = turn(camera.turn_y_deg);
  json["tilt"] = turn(camera.turn_x_deg);
  json["roll"] = turn(camera.turn_z_deg);
  return json;
}

// Returns the mean modulation of a grating over both axes, grey levels. NaN if it was not measured.
double modulation_of(const PatchReading& patch) {
  if (!patch.valid) return kNotMeasured;
  double sum = 0.0, count = 0.0;
  for (const double m : patch.modulation) {
    if (!std::isfinite(m)) continue;
    sum += m;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : kNotMeasured;
}

Json quality_json(const Measurement& m, PackedColumns& columns) {
  Json modulation = Json::array();
  const Reference& reference = *m.reference;
  const std::size_t markers = reference.site.markers.size();
  std::vector<std::vector<double>> now(markers);  // per marker and frame
  for (const Observation& seen : m.observations) {
    for (std::size_t i = 0; i < markers; ++i)
      now[i].push_back(seen.markers[i].loss == Loss::kNone ? modulation_of(seen.markers[i].patch) : kNotMeasured);
  }
  for (std::size_t i = 0; i < markers; ++i) {
    const double then = modulation_of(reference.seen.markers[i].patch);
    if (!(then > 0.0)) continue;
    std::vector<double>& relative = now[i];
    for (double& value : relative) value /= then;
    modulation.push_back({{"name", reference.site.markers[i].name},
                          {"role", reference.site.markers[i].role == Role::kTarget ? "target" : "reference"},
                          {"then", then},
                          {"relative", columns.add(relative, kShareQuantum)}});
  }
  return {{"modulation", std::move(modulation)},
          {"chi2", !m.chi2_dof.empty() ? Json(columns.add(m.chi2_dof, kShareQuantum)) : Json(nullptr)}};
}

Json statuses_json() {
  Json list = Json::array();
  for (const Status status : page_statuses())
    list.push_back({{"word", word_for(status)}, {"meaning", words_of(status).meaning}});
  return list;
}

// Adds the series that only a run with a reference frame has.
void add_series(const Measurement& m, const CameraMotion& camera, Json& json, PackedColumns& columns) {
  std::vector<double> frame, time;
  for (const Observation& seen : m.observations) {
    frame.push_back(static_cast<double>(seen.frame));
    time.push_back(seen.time_s);
  }
  json["frame"] = columns.add(frame, 1.0);
  const bool has_time = std::all_of(time.begin(), time.end(), [](double t) { return std::isfinite(t); });
  json["time"] = has_time ? Json(columns.add(time, kTimeQuantum)) : Json(nullptr);
  for (std::size_t k = 0; k < m.targets.size(); ++k) {
    json["targets"].push_back(
        {{"name", m.reference->site.markers[m.targets[k].marker].name},
         {"rows", rows_json(m, m.targets[k], columns)},
         {"lowest", extent_json(m.targets[k].lowest)},
         {"highest", extent_json(m.targets[k].highest)},
         {"spectrum", {{"x", spectrum_json(m.spectra[k].x, columns)}, {"y", spectrum_json(m.spectra[k].y, columns)}}}});
  }
  json["camera"] = camera_json(camera, columns);
  json["quality"] = quality_json(m, columns);
}

}  // namespace

std::string report_page(const Measurement& m, const MeasureOptions& options, const std::string& run_json,
                        const std::vector<std::uint8_t>& overlay) {
  CameraMotion camera;
  if (m.reference) camera = camera_motion(*m.reference, m.observations, known_camera(*m.reference, stated_scene(m)));
  const Words words = words_of(WordedRun{m, options, camera});
  const std::string name = std::filesystem::path(m.input.path).filename().string();
  PackedColumns columns;
  Json json{{"version", kVersion},
            {"input", name.empty() ? m.input.path : name},
            {"outcome", words.outcome},
            {"exit_code", static_cast<int>(m.exit)},
            {"method", {{"name", options.method->name}, {"summary", options.method->summary}}},
            {"summary", words.summary},
            {"advice", words.advice},
            {"warnings", m.warnings},
            {"statuses", statuses_json()},
            {"targets", Json::array()},
            {"frame", nullptr}};
  if (m.reference) add_series(m, camera, json, columns);
  json["columns"] = columns.index();
  return assembled_page(
      json["input"].get<std::string>(),
      {{"report", "application/json", for_script(json.dump(-1, ' ', false, Json::error_handler_t::replace))},
       {"run", "application/json", for_script(run_json)},
       {"samples", "text/plain", columns.base64()},
       {"overlay", "text/plain", base64_of(page_picture(overlay))}});
}

}  // namespace moiregauge::internal
