// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/report_additions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/report/packed_columns.h"

namespace moiregauge::internal {
namespace {

using AddedJson = nlohmann::ordered_json;

// Quantum of plotted values in u, as for the samples of the page: the rounding error is at most 1.4 % of u (rms).
constexpr double kAddedPartOfU = 0.05;
constexpr double kMinRelativeQuantum = 1e-9;  // relative to the largest value; used if u is tiny
constexpr double kAddedTimeQuantum = 1e-6;    // s

AddedJson finite(double value) { return std::isfinite(value) ? AddedJson(value) : AddedJson(nullptr); }

AddedJson pair_json(const ValueWithU& value) { return {{"value", finite(value.value)}, {"u", finite(value.u)}}; }

AddedJson extreme_of(const Extreme& extreme) {
  AddedJson json = pair_json(extreme.value);
  json["time_s"] = finite(extreme.time_s);
  return json;
}

// Returns the quantum of values with this u.
double quantum_of(const std::vector<double>& values, double u) {
  double largest = 0.0;
  for (const double value : values) largest = std::fmax(largest, std::abs(value));
  const double least = std::fmax(kMinRelativeQuantum * largest, 1e-12);
  return decade_below(std::isfinite(u) ? kAddedPartOfU * u : least, least);
}

AddedJson channel_json(const DerivedColumn& column, const ChannelStatistics& of, PackedColumns& columns) {
  const double quantum = quantum_of(column.value, of.u_rms);
  std::vector<double> status;
  for (const Status s : column.status) status.push_back(status_code(s));
  return {{"unit", column.unit},
          {"value", columns.add(column.value, quantum)},
          {"u", columns.add(column.u, quantum)},
          {"status", columns.add(status, 1.0)},
          {"rows", of.rows},
          {"ok", of.ok},
          {"mean", pair_json(of.mean)},
          {"rms", pair_json(of.rms)},
          {"peak_to_peak", pair_json(of.peak_to_peak)},
          {"smallest", extreme_of(of.smallest)},
          {"largest", extreme_of(of.largest)}};
}

AddedJson choice_json(const std::vector<Layer>& layers, const LayerChoice& choice, PackedColumns& columns) {
  const DerivedTable& table = choice.channels.table;
  bool has_median = false;
  for (std::size_t k = 0; k < layers.size(); ++k)
    has_median = has_median || (choice.is_on[k] && std::holds_alternative<MedianLayer>(layers[k].what));
  const std::vector<double> frames(table.frame.begin(), table.frame.end());
  const bool has_time =
      std::all_of(table.time_s.begin(), table.time_s.end(), [](double t) { return std::isfinite(t); });
  AddedJson json{{"on", choice.is_on},
                 {"u_is_bound", has_median},
                 {"frame", frames.empty() ? AddedJson(nullptr) : AddedJson(columns.add(frames, 1.0))},
                 {"time", has_time ? AddedJson(columns.add(table.time_s, kAddedTimeQuantum)) : AddedJson(nullptr)},
                 {"channels", AddedJson::array()}};
  for (std::size_t k = 0; k < table.columns.size(); ++k)
    json["channels"].push_back(channel_json(table.columns[k], choice.channels.statistics[k], columns));
  return json;
}

PageScript script_of(const char* id, AddedJson json, const PackedColumns& columns) {
  json["columns"] = columns.index();
  json["samples"] = columns.base64();
  return {id, "application/json", for_script(json.dump(-1, ' ', false, AddedJson::error_handler_t::replace))};
}

}  // namespace

PageScript derived_script(const std::vector<Layer>& layers, const std::vector<LayerChoice>& choices) {
  PackedColumns columns;
  AddedJson json{{"layers", AddedJson::array()}, {"channels", AddedJson::array()}, {"states", AddedJson::array()}};
  for (const Layer& layer : layers) json["layers"].push_back(layer.text);
  for (const DerivedColumn& column : choices.front().channels.table.columns)
    json["channels"].push_back({{"name", column.name}, {"expression", column.expression}});
  for (const LayerChoice& choice : choices) json["states"].push_back(choice_json(layers, choice, columns));
  return script_of("derived", std::move(json), columns);
}

PageScript comparison_script(const Comparison& comparison, const std::string& json) {
  std::vector<double> time, measured, reference, u;
  for (const ComparedRow& row : comparison.rows) {
    time.push_back(row.time_s);
    measured.push_back(row.measured);
    reference.push_back(row.reference);
    u.push_back(row.u);
  }
  PackedColumns columns;
  const double quantum = quantum_of(measured, comparison.rms_u);
  AddedJson figures = AddedJson::parse(json);
  figures["rows"] = {{"time", columns.add(time, kAddedTimeQuantum)},
                     {"moiregauge", columns.add(measured, quantum)},
                     {"reference", columns.add(reference, quantum)},
                     {"u", columns.add(u, quantum)}};
  figures["reference"] = std::filesystem::path(figures["reference"].get<std::string>()).filename().string();
  return script_of("comparison", std::move(figures), columns);
}

tl::expected<std::string, UnchangedReport> update_report(const std::string& folder, const PageScript& script) {
  const std::string path = (std::filesystem::path(folder) / "report.html").string();
  const auto file = open_plain_file(path);
  if (!file)
    return tl::unexpected(UnchangedReport{
        true, fmt::format("the report does not show the new results: {} ({}): make it with `moiregauge solve`", path,
                          file.error())});
  std::string page;
  std::array<char, 1 << 16> block{};
  for (std::size_t read = 1; read > 0;) {
    read = std::fread(block.data(), 1, block.size(), file->get());
    page.append(block.data(), read);
  }
  const auto changed = page_with(page, script);
  if (!changed)
    return tl::unexpected(UnchangedReport{
        true, fmt::format("the report does not show the new results: {} is not a report of moiregauge: make it with "
                          "`moiregauge solve`",
                          path)});
  if (const auto written = write_file_atomically(path, *changed); !written)
    return tl::unexpected(UnchangedReport{
        false, fmt::format("the report could not be written: {}: free space or choose another file with -o",
                           written.error())});
  return path;
}

}  // namespace moiregauge::internal
