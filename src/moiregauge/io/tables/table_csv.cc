// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/table_csv.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {

std::string long_csv(const RunTable& table) {
  std::string text = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status\n";
  for (const Sample& s : table.samples) {
    text += fmt::format("{},{},{},{},{},{},{},{}\n", s.frame, csv_number(s.time_s),
                        csv_field(table.markers[s.marker].name), csv_number(s.displacement.x),
                        csv_number(s.displacement.y), csv_number(s.u.x), csv_number(s.u.y), word_for(s.status));
  }
  return text;
}

std::string wide_csv(const RunTable& table) {
  std::string text = "frame,time_s";
  for (const TableMarker& marker : table.markers) {
    for (const char* column : {"dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm", "ok"})
      text += "," + csv_field(fmt::format("{}_{}", marker.name, column));
  }
  text += "\n";
  std::vector<const Sample*> row(table.markers.size());
  for (std::size_t i = 0; i < table.samples.size();) {
    const Sample& first = table.samples[i];
    std::fill(row.begin(), row.end(), nullptr);
    for (; i < table.samples.size() && table.samples[i].frame == first.frame; ++i)
      row[table.samples[i].marker] = &table.samples[i];
    text += fmt::format("{},{}", first.frame, csv_number(first.time_s));
    for (const Sample* s : row) {
      text += s == nullptr
                  ? std::string(",NaN,NaN,NaN,NaN,0")
                  : fmt::format(",{},{},{},{},{}", csv_number(s->displacement.x), csv_number(s->displacement.y),
                                csv_number(s->u.x), csv_number(s->u.y), s->status == Status::kOk ? 1 : 0);
    }
    text += "\n";
  }
  return text;
}

}  // namespace moiregauge::internal
