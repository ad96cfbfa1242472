// SPDX-License-Identifier: Apache-2.0
// Options of `moiregauge measure`, as typed and parsed. Command line, library and Python share them.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/app/marker_choice_args.h"
#include "moiregauge/app/usage_error.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

struct PrintScaleArgs {
  std::string factor;       // "1.0012", or "1.0012,0.9990" along x and y
  std::optional<double> u;  // relative
};

// Arguments as typed.
struct MeasureArgs {
  std::string input;
  std::string site;
  std::string pitch;
  std::string axes;
  std::string method{kDefaultMethod};
  std::string camera;
  std::optional<double> fps;
  std::optional<double> slow_motion;
  std::int64_t max_pixels = InputOptions{}.max_pixels;
  std::optional<long> reference_frame;
  std::string frames;
  std::string rest;
  std::string zero;
  std::string readout;
  PrintScaleArgs print_scale;
  MarkerChoiceArgs choice;
  std::string template_use;
  std::string tone;
  std::string output;
  std::string stabilised;
  std::string figures;
  bool video = false;
  std::optional<double> exaggeration;
  bool sequence = false;
  bool resume = false;
  bool restart = false;
  bool quiet = false;
  bool json = false;
  int threads = 0;
};

[[nodiscard]] tl::expected<MeasureOptions, UsageError> parse_measure_options(const MeasureArgs& args);

// Each parses one argument that `measure` and `solve` share. Fails: the text is not valid for the option.
[[nodiscard]] tl::expected<const Method*, UsageError> method_of(const std::string& word);
[[nodiscard]] tl::expected<Site, UsageError> site_of_file(const std::string& path);
// Reads a site file into the options, with its channels.
[[nodiscard]] tl::expected<void, UsageError> take_site(const std::string& path, MeasureOptions& options);
// Reads a camera file into the options, with its uncertainties.
[[nodiscard]] tl::expected<void, UsageError> take_camera(const std::string& path, MeasureOptions& options);
[[nodiscard]] tl::expected<double, UsageError> readout_time(const std::string& text);  // s, from "18ms"
// Checks the options that change the frames' times, where they are given.
[[nodiscard]] tl::expected<void, UsageError> check_times(std::optional<double> fps, std::optional<double> slow_motion);

// Returns nothing if no scale is given.
[[nodiscard]] tl::expected<std::optional<PrintScale>, UsageError> print_scale_of(const PrintScaleArgs& args);

// Returns the message about a text file: one line that names the file, then `lines`. Each line has one mistake and its
// position. kind: "site file".
[[nodiscard]] std::string mistakes_in(const std::string& kind, const std::string& path, const std::string& lines);

// Returns <input name without extension, or before %> + suffix, in the current directory.
[[nodiscard]] std::string default_output(const std::string& input, const std::string& suffix = "-moiregauge");

// Returns an error if the camera is calibrated for another image size.
[[nodiscard]] std::optional<std::string> camera_problem(const Camera& camera, const InputInfo& input);

}  // namespace moiregauge::internal
