// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/displacement_csv.h"

#include <fmt/format.h>

#include "moiregauge/base/csv_field.h"

namespace moiregauge::internal {

std::string displacement_csv(const Site& site, const Samples& samples) {
  std::string text = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status\n";
  for (const Sample& s : samples) {
    text += fmt::format("{},{},{},{},{},{},{},{}\n", s.frame, csv_number(s.time_s),
                        csv_field(site.markers[s.marker].name), csv_number(s.displacement.x),
                        csv_number(s.displacement.y), csv_number(s.u.x), csv_number(s.u.y), word_for(s.status));
  }
  return text;
}

}  // namespace moiregauge::internal
