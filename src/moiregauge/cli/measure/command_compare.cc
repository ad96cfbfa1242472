// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_compare.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "moiregauge/app/comparison/compare_run.h"
#include "moiregauge/base/rounded_text.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/stage_display.h"
#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kPercent = 100.0;
constexpr int kComparedDecimals = 9;

std::string estimate_line(const char* name, const Estimate& estimate, double scale, const std::string& unit) {
  const double expanded = kComparisonCoverage * estimate.u * scale;
  const int decimals = expanded > 0.0 ? decimals_for(expanded, kComparedDecimals) : kComparedDecimals;
  return fmt::format("  {:<16}{:>14.{}f} +- {:<10.{}f}{}\n", name, scale * estimate.value + 0.0, decimals, expanded,
                     decimals, unit);
}

std::string comparison_text(const ComparedRun& run) {
  constexpr double kMilliseconds = 1e3, kPpm = 1e6;
  const Comparison& c = run.comparison;
  const Alignment& a = c.alignment;
  const std::string& unit = run.origin.unit;
  std::string text =
      fmt::format("compared: {} rows, correlation {:.6f}, +- is U with k = 2\n", c.rows.size(), c.correlation);
  text += estimate_line("time offset", a.offset_s, kMilliseconds,
                        fmt::format("ms at {:.3f} s: the reference's clock minus the recording's", a.middle_s));
  text += a.has_rate ? estimate_line("clock rate", a.rate, kPpm, "ppm: positive if the reference's clock is faster")
                     : fmt::format("  {:<16}{:>14} (fixed: the record does not determine it)\n", "clock rate", 0);
  text += estimate_line("slope", a.slope, 1.0, "moiregauge by reference");
  text += estimate_line("bias", a.bias, 1.0, unit + ": moiregauge minus reference");
  const auto decimals = [](double value) {
    return value > 0.0 ? decimals_for(value, kComparedDecimals) : kComparedDecimals;
  };
  const int fine = decimals(c.rms_difference);
  text += fmt::format("  {:<16}{:>14.{}f} {} rms about the bias\n", "difference", c.rms_difference, fine, unit);
  text += fmt::format("  {:<16}{:>14.{}f} to {:.{}f} {} (95 % of rows)\n", "agreement", c.lower_limit, fine,
                      c.upper_limit, fine, unit);
  text += fmt::format("  {:<16}{:>14.{}f} {} rms\n", "u of moiregauge", c.rms_u, decimals(c.rms_u), unit);
  text += fmt::format("  {:<16}{:>14.1f} % of rows (95 % if u is the whole difference)\n", "coverage of U",
                      kPercent * c.coverage);
  text += c.explained >= 1.0
              ? fmt::format("  {:<16}{:>14} the whole variance of the difference\n", "u explains", "")
              : fmt::format("  {:<16}{:>14.1f} % of the variance of the difference; {:.3g} {} rms remain\n",
                            "u explains", kPercent * c.explained, c.rms_unexplained, unit);
  return text;
}

tl::expected<ComparedRun, RunFailure> compare_shown(const CompareArgs& args) {
  StageDisplay display(args.solve.quiet);
  return run_compare(args, display.callbacks());
}

int run_compare_command(const CompareArgs& args) {
  const auto run = compare_shown(args);
  if (!run) return fail(run.error().exit, run.error().message);
  if (args.solve.quiet) return static_cast<int>(run->exit);
  for (const std::string& warning : run->comparison.warnings)
    print_note((warning.rfind("note: ", 0) == 0 ? "" : "warning: ") + warning + "\n");
  print_out(comparison_text(*run));
  print_out(fmt::format("written: {}\n", run->folder));
  if (!run->report.empty()) print_out(fmt::format("shown in: {}\n", run->report));
  return static_cast<int>(run->exit);
}

void add_reference_options(CLI::App& command, CompareArgs& args) {
  command.add_option("--column", args.column, "column of the values: number from 1, or name [2]")->type_name("NAME");
  command.add_option("--time-column", args.time_column, "column of the times: number from 1, or name [1]")
      ->type_name("NAME");
  command.add_option("--time-unit", args.time_unit, "unit of the times [by the column's name, otherwise s]")
      ->type_name("s|ms|us|min|h");
  command.add_option("--rate", args.rate_hz, "rate of the rows, if there is no column of times")->type_name("HZ");
  command.add_option("--unit", args.unit, "unit of the values [mm]")->type_name("mm|cm|m|um|in");
  command.add_option("--sign", args.sign, "-1: the axes of both sensors are opposite")->type_name("1|-1");
  command.add_option("--scale", args.scale, "factor of the values")->type_name("F");
  command.add_option("--offset", args.offset_s, "known time offset in s: reference minus recording")->type_name("T");
}

}  // namespace

void add_compare(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("compare", "Compare a channel of a finished run with the record of another sensor");
  auto args = std::make_shared<CompareArgs>();
  command->add_option("DIR", args->solve.run, "folder that `measure` wrote")->type_name("DIR")->required();
  command->add_option("REFERENCE", args->reference, "CSV file of the other sensor")->type_name("FILE")->required();
  command->add_option("--channel", args->channel, "channel to compare, e.g. mid.dy; expressions as for `derive`")
      ->type_name("TEXT")
      ->required();
  add_reference_options(*command, *args);
  command->add_option("--site", args->solve.site, "the site that `solve` was given")->type_name("FILE");
  command->add_option("--camera", args->solve.camera, "the camera that `solve` was given")->type_name("FILE");
  command->add_option("--rest", args->solve.rest, "the rest frames that `solve` was given")->type_name("A:B|none");
  command->add_option("--readout", args->solve.readout, "the readout time that `solve` was given")->type_name("TIME");
  command->add_option("--fps", args->solve.fps, "the frame rate that `solve` was given")->type_name("N");
  add_slow_motion(*command, args->solve.slow_motion);
  add_print_scale(*command, args->solve.print_scale);
  command->add_option("-o,--out", args->output, "folder to write [DIR/comparison]")->type_name("DIR");
  command->add_flag("--quiet", args->solve.quiet, "print nothing but errors");
  command->callback([args, &exit_code] { exit_code = run_compare_command(*args); });
}

}  // namespace moiregauge::internal::cli
