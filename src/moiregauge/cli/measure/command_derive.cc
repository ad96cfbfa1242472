// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_derive.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/app/derive_run.h"
#include "moiregauge/base/rounded_text.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/stage_display.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/report/report_text.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::cli {
namespace {

tl::expected<DerivedResults, RunFailure> derive_shown(const DeriveArgs& args) {
  StageDisplay display(args.solve.quiet);
  return run_derive(args, display.callbacks());
}

constexpr int kMaxDecimals = 12;  // units may be stated by the user, and be large

// Returns one line per channel: peak to peak, mean and rms with U, and its rows. Each is rounded to two significant
// digits of its U.
std::string channel_text(const DerivedColumn& column, const ChannelStatistics& of) {
  if (of.ok == 0) return fmt::format("{} = {}: no ok row has a value\n", column.name, column.expression);
  const auto rounded = [](double value, double expanded) {
    if (!(expanded > 0.0)) return fmt::format("{:.6g}", value + 0.0);
    return fmt::format("{:.{}f}", value + 0.0, decimals_for(expanded, kMaxDecimals));
  };
  const auto with_u = [&](const ValueWithU& value) {
    const double expanded = kCoverageFactor * value.u;
    return fmt::format("{} (U {})", rounded(value.value, expanded), rounded(expanded, expanded));
  };
  const double expanded = kCoverageFactor * of.u_rms;
  return fmt::format("{} = {}, in {}: peak to peak {}, mean {}, rms {}; rows: U {}, {} of {} ok\n", column.name,
                     column.expression, column.unit, with_u(of.peak_to_peak), with_u(of.mean), with_u(of.rms),
                     rounded(expanded, expanded), of.ok, of.rows);
}

// Returns a line on the peak, and one line per axis with ratio, phase and their U.
std::string mode_text(std::size_t number, const ModeShape& shape, const std::vector<std::string>& targets) {
  const auto name = [&](const ModeEntry& e) {
    return fmt::format("{}.{}", targets[e.target], e.axis == BoardAxis::kX ? "dx" : "dy");
  };
  const auto rounded = [](double value, double expanded) {
    return fmt::format("{:.{}f}", value + 0.0, expanded > 0.0 ? decimals_for(expanded) : 0);
  };
  const double expanded_hz = kCoverageFactor * shape.peak.u_frequency_hz;
  std::string text = fmt::format(
      "mode {}: {} Hz (U {}), {}, largest in {} with {:.4g} mm; ratio and phase to it, U with k = {:g}\n", number,
      rounded(shape.peak.frequency_hz, expanded_hz), rounded(expanded_hz, expanded_hz), word_for(shape.peak.kind),
      name(shape.entries[shape.reference]), shape.peak.amplitude_mm, kCoverageFactor);
  std::size_t width = 0;
  for (const ModeEntry& e : shape.entries) width = std::max(width, name(e).size());
  for (const ModeEntry& e : shape.entries) {
    const double ratio = kCoverageFactor * e.u_ratio;
    const double phase = kCoverageFactor * degrees_from_radians(e.u_phase_rad);
    const bool has_phase = e.ratio > ratio;
    text += fmt::format("  {:<{}}  {:>8} (U {:>7})  {:>8} deg{}\n", name(e), width, rounded(e.ratio, ratio),
                        rounded(ratio, ratio), has_phase ? rounded(degrees_from_radians(e.phase_rad), phase) : "-",
                        has_phase ? fmt::format(" (U {})", rounded(phase, phase)) : "");
  }
  return text;
}

int run_derive_command(const DeriveArgs& args) {
  const auto derived = derive_shown(args);
  if (!derived) return fail(derived.error().exit, derived.error().message);
  if (args.solve.quiet) return static_cast<int>(derived->exit);
  for (const std::string& note : derived->warnings) print_note(note + "\n");
  for (std::size_t k = 0; k < derived->statistics.size(); ++k)
    print_out(channel_text(derived->table.columns[k], derived->statistics[k]));
  for (std::size_t k = 0; k < derived->modes.size(); ++k)
    print_out(mode_text(k + 1, derived->modes[k], derived->targets));
  print_out(fmt::format("written: {}\n", fmt::join(derived->files, ", ")));
  if (!derived->report.empty()) print_out(fmt::format("shown in: {}\n", derived->report));
  return static_cast<int>(derived->exit);
}

// Options that give a layer. They apply in the order in which they are typed.
struct LayerOption {
  const char* name;
  const char* type;
  const char* help;
};
constexpr LayerOption kLayerOptions[] = {
    {"zero", "A:B", "subtract the mean over these frames or seconds, half open"},
    {"filter", "TEXT", "zero-phase filter: lowpass:5Hz, highpass:0.2Hz or bandpass:1Hz-5Hz"},
    {"velocity", "FREQUENCY", "derivative of the series below this frequency, e.g. 5Hz"},
    {"resample", "FREQUENCY", "even times by linear interpolation, e.g. 50Hz"},
    {"median", "N", "moving median of an odd number of rows"},
};

// Collects the layers in the order of the command line.
std::vector<std::pair<std::string, std::string>> layers_as_typed(const CLI::App& command) {
  std::vector<std::pair<std::string, std::string>> layers;
  std::map<const CLI::Option*, std::size_t> used;
  for (const CLI::Option* option : command.parse_order()) {
    const std::string name = option->get_single_name();
    if (name == "detrend") layers.emplace_back(name, "");
    for (const LayerOption& layer : kLayerOptions) {
      if (name == layer.name) layers.emplace_back(name, option->results()[used[option]++]);
    }
  }
  return layers;
}

void add_layers(CLI::App& command) {
  for (const LayerOption& layer : kLayerOptions) {
    command.add_option(fmt::format("--{}", layer.name), layer.help)
        ->type_name(layer.type)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
  command.add_flag("--detrend")->description("subtract the least squares line");
}

}  // namespace

void add_derive(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("derive", "Combine displacements of a finished run to channels with their own u");
  auto args = std::make_shared<DeriveArgs>();
  command->add_option("DIR", args->solve.run, "folder that `measure` wrote")->type_name("DIR")->required();
  command
      ->add_option("--channel", args->channels,
                   "channel: 'NAME = EXPRESSION', e.g. 'sag = mid.dy - (left.dy + right.dy) / 2'; may be repeated "
                   "[those of the site file]")
      ->type_name("TEXT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_layers(*command);
  command->add_option("--method", args->solve.method, "the method that `solve` was given")
      ->type_name("two-stage|precise|conventional");
  command->add_option("--site", args->solve.site, "the site that `solve` was given")->type_name("FILE");
  command->add_option("--camera", args->solve.camera, "the camera that `solve` was given")->type_name("FILE");
  command->add_option("--rest", args->solve.rest, "the rest frames that `solve` was given")->type_name("A:B|none");
  command->add_option("--readout", args->solve.readout, "the readout time that `solve` was given")->type_name("TIME");
  command->add_option("--fps", args->solve.fps, "the frame rate that `solve` was given")->type_name("N");
  add_slow_motion(*command, args->solve.slow_motion);
  add_print_scale(*command, args->solve.print_scale);
  command->add_option("-o,--out", args->output, "CSV file to write [DIR/derived.csv]")->type_name("FILE");
  command->add_flag("--modes", args->has_modes, "also mode shapes: amplitude ratio and phase at every named peak");
  command->add_flag("--quiet", args->solve.quiet, "print nothing but errors");
  command->callback([args, command, &exit_code] {
    args->layers = layers_as_typed(*command);
    exit_code = run_derive_command(*args);
  });
}

}  // namespace moiregauge::internal::cli
