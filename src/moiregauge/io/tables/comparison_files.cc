// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/comparison_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/csv_field.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using ComparisonJson = nlohmann::ordered_json;

// Minus zero becomes zero. NaN becomes null when it is written.
ComparisonJson estimate_json(const Estimate& estimate, double scale) {
  return {
      {"value", scale * estimate.value + 0.0}, {"u", scale * estimate.u}, {"u_channel", scale * estimate.u_channel}};
}

}  // namespace

std::string comparison_csv(const Comparison& comparison) {
  std::string text = "time_s,moiregauge,reference,difference,u,in_U\n";
  for (const ComparedRow& row : comparison.rows)
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", csv_number(row.time_s), row.measured + 0.0,
                        row.reference + 0.0, row.difference + 0.0, row.u, row.is_in_U ? 1 : 0);
  return text;
}

std::string comparison_json(const Comparison& c, const ComparisonOrigin& origin) {
  constexpr double kPpm = 1e6;
  const Alignment& a = c.alignment;
  const ComparisonJson json{{"moiregauge", kVersion},
                            {"run", origin.run},
                            {"reference", origin.reference},
                            {"channel", origin.channel},
                            {"unit", origin.unit},
                            {"reference_factor", origin.factor},
                            {"rows", c.rows.size()},
                            {"compared_at", a.is_channel_interpolated ? "reference" : "frames"},
                            {"offset_s", estimate_json(a.offset_s, 1.0)},
                            {"offset_at_time_s", a.middle_s},
                            {"clock_ppm", estimate_json(a.rate, kPpm)},
                            {"is_clock_fitted", a.has_rate},
                            {"slope", estimate_json(a.slope, 1.0)},
                            {"bias", estimate_json(a.bias, 1.0)},
                            {"correlation", c.correlation},
                            {"rms_difference", c.rms_difference},
                            {"rms_residual", a.residual_rms},
                            {"residual_autocorrelation", a.residual_autocorrelation},
                            {"limits_of_agreement", {c.lower_limit, c.upper_limit}},
                            {"rms_u", c.rms_u},
                            {"coverage_of_U", c.coverage},
                            {"share_explained_by_u", c.explained},
                            {"rms_unexplained", c.rms_unexplained},
                            {"warnings", c.warnings}};
  return json.dump(2, ' ', false, ComparisonJson::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal
