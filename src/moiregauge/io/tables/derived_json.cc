// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/derived_json.h"

#include <cmath>
#include <variant>

#include <nlohmann/json.hpp>

#include "moiregauge/io/tables/derived_csv.h"
#include "moiregauge/version.h"

namespace moiregauge::internal {
namespace {

using DerivedJson = nlohmann::ordered_json;

DerivedJson real(double value) { return std::isfinite(value) ? DerivedJson(value) : DerivedJson(nullptr); }

DerivedJson with_u(const ValueWithU& value) { return {{"value", real(value.value)}, {"u", real(value.u)}}; }

DerivedJson extreme_json(const Extreme& extreme) {
  DerivedJson json = with_u(extreme.value);
  json["time_s"] = real(extreme.time_s);
  json["frame"] = extreme.frame >= 0 ? DerivedJson(extreme.frame) : DerivedJson(nullptr);
  return json;
}

}  // namespace

std::string derived_json(const DerivedTable& table, const std::vector<ChannelStatistics>& statistics,
                         const std::vector<Layer>& layers) {
  DerivedJson json{{"moiregauge", kVersion}, {"layers", DerivedJson::array()}, {"channels", DerivedJson::array()}};
  bool has_median = false;
  for (const Layer& layer : layers) {
    json["layers"].push_back(layer.text);
    has_median = has_median || std::holds_alternative<MedianLayer>(layer.what);
  }
  json["u_is_bound"] = has_median;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const DerivedColumn& column = table.columns[k];
    const ChannelStatistics& of = statistics[k];
    json["channels"].push_back({{"name", column.name},
                                {"expression", column.expression},
                                {"unit", column.unit},
                                {"column", column_name(column.name, column.unit)},
                                {"rows", of.rows},
                                {"ok", of.ok},
                                {"u", real(of.u_rms)},
                                {"mean", with_u(of.mean)},
                                {"rms", with_u(of.rms)},
                                {"peak_to_peak", with_u(of.peak_to_peak)},
                                {"smallest", extreme_json(of.smallest)},
                                {"largest", extreme_json(of.largest)}});
  }
  return json.dump(2, ' ', false, DerivedJson::error_handler_t::replace) + "\n";
}

}  // namespace moiregauge::internal
