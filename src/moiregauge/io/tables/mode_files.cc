// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/mode_files.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/csv_field.h"
#include "moiregauge/units/units.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using ModeJson = nlohmann::ordered_json;

const char* axis_name(BoardAxis axis) { return axis == BoardAxis::kX ? "x" : "y"; }

ModeJson mode_number(double value) { return std::isfinite(value) ? ModeJson(value) : ModeJson(nullptr); }

ModeJson entry_json(const ModeEntry& entry, const std::vector<std::string>& names) {
  return {
      {"target", names[entry.target]},
      {"axis", axis_name(entry.axis)},
      {"ratio", mode_number(entry.ratio)},
      {"phase_deg", mode_number(degrees_from_radians(entry.phase_rad))},
      {"u",
       {{"ratio", mode_number(entry.u_ratio)}, {"phase_deg", mode_number(degrees_from_radians(entry.u_phase_rad))}}}};
}

}  // namespace

std::string modes_csv(const std::vector<ModeShape>& shapes, const std::vector<std::string>& names) {
  std::string text = "mode,frequency_hz,u_frequency_hz,kind,target,axis,ratio,u_ratio,phase_deg,u_phase_deg\n";
  for (std::size_t mode = 0; mode < shapes.size(); ++mode) {
    const Peak& peak = shapes[mode].peak;
    for (const ModeEntry& e : shapes[mode].entries)
      text += fmt::format("{},{:.9g},{:.3g},{},{},{},{:.9g},{:.3g},{:.9g},{:.3g}\n", mode + 1, peak.frequency_hz,
                          peak.u_frequency_hz, word_for(peak.kind), csv_field(names[e.target]), axis_name(e.axis),
                          e.ratio, e.u_ratio, degrees_from_radians(e.phase_rad), degrees_from_radians(e.u_phase_rad));
  }
  return text;
}

std::string modes_json(const std::vector<ModeShape>& shapes, const std::vector<std::string>& names) {
  ModeJson json{{"moiregauge", kVersion}, {"modes", ModeJson::array()}};
  for (const ModeShape& shape : shapes) {
    const Peak& peak = shape.peak;
    const ModeEntry& reference = shape.entries[shape.reference];
    ModeJson mode{{"kind", word_for(peak.kind)},
                  {"frequency_hz", mode_number(peak.frequency_hz)},
                  {"damping", mode_number(peak.damping)},
                  {"u", {{"frequency_hz", mode_number(peak.u_frequency_hz)}, {"damping", mode_number(peak.u_damping)}}},
                  {"reference", {{"target", names[reference.target]}, {"axis", axis_name(reference.axis)}}},
                  {"amplitude_mm", mode_number(peak.amplitude_mm)},
                  {"rows", shape.rows},
                  {"resolution_hz", shape.resolution_hz},
                  {"shape", ModeJson::array()}};
    for (const ModeEntry& entry : shape.entries) mode["shape"].push_back(entry_json(entry, names));
    json["modes"].push_back(std::move(mode));
  }
  return json.dump(2, ' ', false, ModeJson::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal
