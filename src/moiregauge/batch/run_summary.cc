// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/run_summary.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "moiregauge/io/tables/run_table.h"

namespace moiregauge::internal {
namespace {

using RunJson = nlohmann::json;

double number_of(const RunJson& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? json[key].get<double>() : kNotMeasured;
}

std::string word_of(const RunJson& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

long count_of(const RunJson& json, const char* key) {
  return json.contains(key) && json[key].is_number_integer() ? json[key].get<long>() : 0;
}

void add_peaks(const RunJson& peaks, char axis, TargetOfRun& target) {
  for (const RunJson& peak : peaks) {
    const RunJson u = peak.value("u", RunJson::object());
    target.peaks.push_back({axis, word_of(peak, "kind"), number_of(peak, "frequency_hz"), number_of(u, "frequency_hz"),
                            number_of(peak, "amplitude_mm"), number_of(peak, "damping"), number_of(u, "damping")});
  }
}

TargetOfRun target_of(const RunJson& json) {
  TargetOfRun target;
  target.marker = word_of(json, "name");
  target.frames = count_of(json, "frames");
  target.ok = count_of(json, "ok");
  target.u = {number_of(json, "u_dx_mm"), number_of(json, "u_dy_mm")};
  target.peak_to_peak = target.rms = {kNotMeasured, kNotMeasured};
  const RunJson peaks = json.value("peaks", RunJson::object());
  add_peaks(peaks.value("x", RunJson::array()), 'x', target);
  add_peaks(peaks.value("y", RunJson::array()), 'y', target);
  return target;
}

RunSummary summary_of(const RunJson& json) {
  RunSummary run;
  const RunJson& input = json.at("input");
  run.version = word_of(json, "moiregauge");
  run.method = word_of(json, "method");
  run.codec = word_of(input, "codec");
  run.sha256 = word_of(input, "sha256");
  run.start_utc = word_of(input, "start_utc");
  run.frames = count_of(input, "frames");
  run.width = static_cast<int>(count_of(input, "width"));
  run.height = static_cast<int>(count_of(input, "height"));
  run.fps = number_of(input, "fps");
  run.is_complete = json.value("complete", false);
  for (const RunJson& warning : json.value("warnings", RunJson::array()))
    run.warnings.push_back(warning.get<std::string>());
  for (const RunJson& target : json.value("targets", RunJson::array())) run.targets.push_back(target_of(target));
  return run;
}

// Range and scatter of one axis over the `ok` rows (results/summary.h defines both).
struct AxisMoments {
  double peak_to_peak = kNotMeasured, rms = kNotMeasured;
};

AxisMoments moments_of(const std::vector<double>& values) {
  double lowest = kNotMeasured, highest = kNotMeasured, mean = 0.0, squares = 0.0;
  long count = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    lowest = std::fmin(lowest, v);
    highest = std::fmax(highest, v);
    const double from_mean = v - mean;  // Welford 1962
    mean += from_mean / static_cast<double>(++count);
    squares += from_mean * (v - mean);
  }
  if (count == 0) return {};
  return {highest - lowest, std::sqrt(squares / static_cast<double>(count))};
}

void add_samples(const RunTable& table, RunSummary& run) {
  std::map<std::string, std::array<std::vector<double>, 2>> ok_values;  // NaN where a row is not `ok`
  for (const Sample& sample : table.samples) {
    auto& values = ok_values[table.markers[sample.marker].name];
    const bool is_ok = sample.status == Status::kOk;
    values[0].push_back(is_ok ? sample.displacement.x : kNotMeasured);
    values[1].push_back(is_ok ? sample.displacement.y : kNotMeasured);
  }
  for (TargetOfRun& target : run.targets) {
    const auto& [x, y] = ok_values[target.marker];
    const AxisMoments along_x = moments_of(x), along_y = moments_of(y);
    target.peak_to_peak = {along_x.peak_to_peak, along_y.peak_to_peak};
    target.rms = {along_x.rms, along_y.rms};
    target.plot = plot_text(target.axis() == 'x' ? x : y);
  }
}

}  // namespace

const PeakOfRun* TargetOfRun::strongest_peak() const {
  const auto strongest = std::max_element(peaks.begin(), peaks.end(), [](const PeakOfRun& a, const PeakOfRun& b) {
    return a.amplitude_mm < b.amplitude_mm;
  });
  return strongest == peaks.end() ? nullptr : &*strongest;
}

std::optional<RunSummary> read_run_summary(const std::filesystem::path& run) {
  std::ifstream json(run / "run.json");
  if (!json) return std::nullopt;
  std::optional<RunSummary> summary;
  try {
    summary = summary_of(RunJson::parse(json));
  } catch (const RunJson::exception&) {
    return std::nullopt;
  }
  std::ifstream csv(run / "displacement.csv");
  RunTable table;
  if (csv && parse_displacement_csv(csv, table)) add_samples(table, *summary);
  return summary;
}

std::string plot_text(const std::vector<double>& values) {
  constexpr double kSteps = 'z' - 'A';
  double lowest = kNotMeasured, highest = kNotMeasured;
  for (const double v : values) lowest = std::fmin(lowest, v), highest = std::fmax(highest, v);
  const double range = highest - lowest;
  const auto character = [&](double v) {
    const double share = range > 0.0 ? (v - lowest) / range : 0.5;
    return static_cast<char>('A' + static_cast<int>(std::lround(kSteps * share)));
  };
  const std::size_t columns = std::min(values.size(), kPlotColumns);
  std::string plot;
  for (std::size_t c = 0; c < columns; ++c) {
    double low = kNotMeasured, high = kNotMeasured;
    for (std::size_t i = c * values.size() / columns; i < (c + 1) * values.size() / columns; ++i)
      low = std::fmin(low, values[i]), high = std::fmax(high, values[i]);
    plot += std::isnan(low) ? std::string("--") : std::string{character(low), character(high)};
  }
  return plot;
}

}  // namespace moiregauge::internal
