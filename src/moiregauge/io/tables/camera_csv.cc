// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/camera_csv.h"

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"
#include "moiregauge/results/camera_motion.h"

namespace moiregauge::internal {

std::vector<CameraRow> camera_rows(const Measurement& measurement) {
  std::vector<CameraRow> rows;
  const auto& scene = stated_scene(measurement);
  if (!measurement.reference || !scene || !known_camera(*measurement.reference, scene)) return rows;
  std::size_t n = 0;
  for (const Observation& seen : measurement.observations) {
    if (n >= measurement.poses.size()) break;
    rows.push_back({seen.frame, seen.time_s, measurement.poses[n++]});
  }
  return rows;
}

std::string camera_csv(const std::vector<CameraRow>& rows) {
  std::string text = "frame,time_s";
  for (const CameraColumn& column : kCameraColumns) text += fmt::format(",{}", column.name);
  text += "\n";
  for (const CameraRow& row : rows) {
    text += fmt::format("{},{}", row.frame, csv_number(row.time_s));
    for (const CameraColumn& column : kCameraColumns) text += "," + csv_number(column.value(row.pose));
    text += "\n";
  }
  return text;
}

}  // namespace moiregauge::internal
