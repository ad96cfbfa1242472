// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/batch_csv.h"

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"
#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal {
namespace {

constexpr double kExpanded = 2.0;  // U = 2 u

std::string row_of(const CollectedClip& clip, const TargetOfRun& target) {
  const PeakOfRun* peak = target.strongest_peak();
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(one_line(clip.clip.input)),
                     csv_field(clip.clip.name), clip.is_finished() ? std::to_string(clip.state->exit_code) : "NaN",
                     csv_field(one_line(target.marker)), target.frames, target.ok, csv_number(target.peak_to_peak.x),
                     csv_number(target.peak_to_peak.y), csv_number(target.rms.x), csv_number(target.rms.y),
                     csv_number(kExpanded * target.u.x), csv_number(kExpanded * target.u.y),
                     csv_number(peak != nullptr ? peak->frequency_hz : kNotMeasured),
                     csv_number(peak != nullptr ? peak->u_frequency_hz : kNotMeasured),
                     csv_number(clip.is_finished() ? clip.state->wall_s : kNotMeasured),
                     csv_field(clip.is_finished() ? one_line(clip.state->message) : "not measured so far"));
}

}  // namespace

std::string batch_csv_header() {
  return "clip,run,exit_code,marker,frames,ok,peak_to_peak_dx_mm,peak_to_peak_dy_mm,rms_dx_mm,rms_dy_mm,U_dx_mm,U_dy_"
         "mm,"
         "f1_hz,u_f1_hz,seconds,message\n";
}

std::string batch_csv_rows(const CollectedClip& clip) {
  if (clip.run && !clip.run->targets.empty()) {
    std::string rows;
    for (const TargetOfRun& target : clip.run->targets) rows += row_of(clip, target);
    return rows;
  }
  TargetOfRun none;
  none.peak_to_peak = none.rms = none.u = {kNotMeasured, kNotMeasured};
  return row_of(clip, none);
}

}  // namespace moiregauge::internal
