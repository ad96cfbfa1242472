// SPDX-License-Identifier: Apache-2.0
// Work on a finished run, without its video, and on single frames: `moiregauge solve`, `derive` and `inspect` as functions.
// A run is the folder that `measure` or the program wrote.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/image.h"
#include "moiregauge/measure.h"
#include "moiregauge/result.h"
#include "moiregauge/units.h"

namespace moiregauge {

// Changes to a run. Whatever is empty stays as it was measured.
struct SolveOptions {
  std::optional<Site> site;  // better positions, angles, heights or uncertainties of the same markers
  std::string site_file;
  std::optional<Camera> camera;  // calibrated
  std::string camera_file;
  std::string method;              // "two-stage", for a run by "precise"
  std::optional<FrameRange> rest;  // frames in which no target moves
  bool has_rest = true;            // false: withdraws the run's own rest
  std::optional<FrameRange> zero;  // displacements are relative to the mean over these frames
  bool has_zero = true;            // false: withdraws the run's own zero
  std::optional<double> fps;       // frames per second; replaces the times
  std::optional<Seconds> readout;  // rolling shutter: first row to last row
  std::string output;              // folder of the new results, or the run's own; empty: nothing is written
};

// Reads a run with the options of its present results. `known`: site or camera of an earlier `solve`, which the folder
// does not store.
// Model: its observations are solved again, so every bit is that of the measurement. Units: mm and s.
// Fails: no run, a damaged or an unfinished one (kInput); results that need a site or camera (kUsage). A refused run is
// no failure: Result::refusal is its reason.
[[nodiscard]] MOIREGAUGE_API Expected<Result> read_run(const std::string& run, const SolveOptions& known = {});

// Solves a run again with other options. Units: mm and s. docs/cli/solve.md.
// Fails: options that the observations do not allow (kUsage), no run (kInput), results not written (kOutput).
// Error: second-order terms of a changed site or lens, docs/cli/solve.md.
[[nodiscard]] MOIREGAUGE_API Expected<Result> solve(const std::string& run, const SolveOptions& options);

struct DeriveOptions {
  std::vector<std::string> channels;  // "sag = mid.dy - (left.dy + right.dy) / 2"; empty: those of the site file
  // Layers in their order: option of docs/cli/derive.md without dashes, and its value: {"filter", "lowpass:5Hz"}.
  std::vector<std::pair<std::string, std::string>> layers;
  SolveOptions solved;  // site, camera, rest, ... with which the results were solved, unless the folder stores them
  std::string output;   // CSV file; empty: nothing is written
};

// Series of one channel. Not measured is NaN.
struct DerivedChannel {
  std::string name, unit, expression;
  std::vector<double> value, u;  // u: standard uncertainty (k = 1)
  std::vector<Status> status;
  double mean = Sample::kNaN, u_mean = Sample::kNaN;                  // over the rows with status kOk
  double rms = Sample::kNaN, u_rms = Sample::kNaN;                    // about the mean
  double peak_to_peak = Sample::kNaN, u_peak_to_peak = Sample::kNaN;  // largest minus smallest
};

struct DerivedChannels {
  std::vector<long> frame;  // empty: the rows are even times after a layer, not frames
  std::vector<double> time_s;
  std::vector<DerivedChannel> channels;
  std::vector<std::string> warnings;
};

// Solves combinations of displacements of a run, with the u that their common errors give. docs/cli/derive.md.
// Fails: a wrong channel or layer (kUsage), no run (kInput), a refused run (kRefused), table not written (kOutput).
// Error: u of every value.
[[nodiscard]] MOIREGAUGE_API Expected<DerivedChannels> derive(const std::string& run, const DeriveOptions& options);

// Writes a copy of a run's report, one file for any browser.
// Fails: the run has no report (kInput), or the file cannot be written (kOutput).
[[nodiscard]] MOIREGAUGE_API Expected<void> write_report(const std::string& run, const std::string& file);

// Scale and site may be absent: lengths are then in pitches.
struct InspectOptions {
  std::optional<Millimetres> pitch;
  std::optional<Site> site;
  std::string site_file;
  std::string camera_file;
  long frame = 0;             // in a video or a folder
  std::optional<double> fps;  // frames per second of a folder of images
};

// Marker of the image. With a scale, mm on the board.
struct InspectedMarker {
  std::string name;
  bool is_reference = false;
  double x_px = Sample::kNaN, y_px = Sample::kNaN;
  double x_mm = Sample::kNaN, y_mm = Sample::kNaN;
  double pitch_px = Sample::kNaN;                         // NaN: no grating
  double u_dx_mm = Sample::kNaN, u_dy_mm = Sample::kNaN;  // expected u of a target's displacement (k = 1)
};

struct Inspection {
  int width = 0, height = 0;  // px
  std::size_t circles = 0, gratings = 0;
  std::vector<InspectedMarker> markers;  // empty: not identified
  std::string problem;                   // why no measurement can begin with this image; empty: it can
  double mm_per_px = Sample::kNaN;
  std::string from, to;  // two references whose distance a tape can check
  double distance_mm = Sample::kNaN;
  std::vector<std::string> warnings;
  std::string json;                       // inspect.json, with everything that was detected
  std::vector<std::uint8_t> overlay_png;  // the image with everything that was detected
};

// Returns what is detected in one frame of a video, a folder of images or an image. Model: docs/cli/inspect.md.
// Fails: unreadable input (kInput), no such frame or wrong options (kUsage). An unusable frame is no failure:
// Inspection::problem is its reason.
// Error: expected u contains noise and codec only.
[[nodiscard]] MOIREGAUGE_API Expected<Inspection> inspect(const std::string& input, const InspectOptions& options);

// Returns what is detected in an image.
// Fails (kUsage): wrong options.
[[nodiscard]] MOIREGAUGE_API Expected<Inspection> inspect(const ImageView& image, const InspectOptions& options);

}  // namespace moiregauge
