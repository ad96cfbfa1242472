// SPDX-License-Identifier: Apache-2.0
// Reads what the catalogue needs from a run directory. The values are those of the run's own files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

struct PeakOfRun {
  char axis = 'y';
  std::string kind;  // "steady", "decay" or "random"
  double frequency_hz = 0.0, u_frequency_hz = 0.0;
  double amplitude_mm = 0.0;
  double damping = 0.0, u_damping = 0.0;  // NaN: none
};

struct TargetOfRun {
  std::string marker;
  long frames = 0, ok = 0;
  Extent<frame::Board> peak_to_peak, rms, u;  // mm, of the `ok` rows; u is the rms of the measured rows. NaN: none
  std::vector<PeakOfRun> peaks;
  std::string plot;  // shows the axis that moves more (plot_text)

  // The axis that moves more.
  [[nodiscard]] char axis() const { return peak_to_peak.x > peak_to_peak.y ? 'x' : 'y'; }
  // Returns the peak with the largest amplitude, or null.
  [[nodiscard]] const PeakOfRun* strongest_peak() const;
};

struct RunSummary {
  std::string version, method, codec, sha256, start_utc;
  long frames = 0;
  int width = 0, height = 0;
  double fps = 0.0;  // NaN: unknown
  bool is_complete = false;
  std::vector<std::string> warnings;
  std::vector<TargetOfRun> targets;
};

// Returns the summary of a run directory, also of a refused run. Nothing: there is no run.json, or it is damaged.
[[nodiscard]] std::optional<RunSummary> read_run_summary(const std::filesystem::path& run);

// Number of columns of a small plot.
inline constexpr std::size_t kPlotColumns = 64;

// Returns values as a small plot of at most kPlotColumns columns of equal numbers of values. Each column has two
// characters, the lowest and the highest value: `A` is the lowest of all, `z` the highest, in 58 steps of ASCII.
// `--` is a column without a value.
[[nodiscard]] std::string plot_text(const std::vector<double>& values);

}  // namespace moiregauge::internal
