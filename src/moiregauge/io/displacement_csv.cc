// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/displacement_csv.h"

#include <cmath>

#include <fmt/format.h>

namespace moiregauge {
namespace {

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? "0.000000" : text;
}

// RFC 4180: a name with a comma or a quote is quoted.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::string displacement_csv(const Site& site, const Samples& samples) {
  std::string text = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status\n";
  for (const Sample& s : samples) {
    text += fmt::format("{},{},{},{},{},{},{},{}\n", s.frame, number(s.time_s), field(site.markers[s.marker].name),
                        number(s.displacement.x), number(s.displacement.y), number(s.u.x), number(s.u.y),
                        word_for(s.status));
  }
  return text;
}

}  // namespace moiregauge
