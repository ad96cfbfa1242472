// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_derive.h"

#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "moiregauge/app/derive_run.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/stage_display.h"
#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {
namespace {

tl::expected<DerivedResults, RunFailure> derive_shown(const DeriveArgs& args) {
  StageDisplay display(args.solve.quiet);
  return run_derive(args, display.callbacks());
}

// Returns one line per channel: its largest and smallest value, its u and its rows.
std::string channel_text(const DerivedColumn& column) {
  double low = kNotMeasured, high = kNotMeasured, variance = 0.0;
  std::size_t ok = 0;
  for (std::size_t n = 0; n < column.value.size(); ++n) {
    if (column.status[n] != Status::kOk || std::isnan(column.value[n])) continue;
    low = std::fmin(low, column.value[n]);
    high = std::fmax(high, column.value[n]);
    variance += column.u[n] * column.u[n];
    ++ok;
  }
  if (ok == 0) return fmt::format("{}: no ok row\n", column.name);
  return fmt::format("{} = {}: {:.6g} to {:.6g} {}, u {:.2g} {} (rms), {} of {} rows ok\n", column.name,
                     column.expression, low, high, column.unit, std::sqrt(variance / static_cast<double>(ok)),
                     column.unit, ok, column.value.size());
}

int run_derive_command(const DeriveArgs& args) {
  const auto derived = derive_shown(args);
  if (!derived) return fail(derived.error().exit, derived.error().message);
  if (args.solve.quiet) return static_cast<int>(derived->exit);
  for (const DerivedColumn& column : derived->table.columns) print_out(channel_text(column));
  print_out(fmt::format("written: {}\n", derived->file));
  return static_cast<int>(derived->exit);
}

}  // namespace

void add_derive(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("derive", "Combine displacements of a finished run to channels with their own u");
  auto args = std::make_shared<DeriveArgs>();
  command->add_option("DIR", args->solve.run, "folder that `measure` wrote")->type_name("DIR")->required();
  command
      ->add_option("--channel", args->channels,
                   "channel: 'NAME = EXPRESSION', e.g. 'sag = mid.dy - (left.dy + right.dy) / 2'; may be repeated")
      ->type_name("TEXT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--site", args->solve.site, "the site that `solve` was given")->type_name("FILE");
  command->add_option("--camera", args->solve.camera, "the camera that `solve` was given")->type_name("FILE");
  command->add_option("--rest", args->solve.rest, "the rest frames that `solve` was given")->type_name("A:B|none");
  command->add_option("--readout", args->solve.readout, "the readout time that `solve` was given")->type_name("TIME");
  command->add_option("--fps", args->solve.fps, "the frame rate that `solve` was given")->type_name("N");
  add_slow_motion(*command, args->solve.slow_motion);
  add_print_scale(*command, args->solve.print_scale);
  command->add_option("-o,--out", args->output, "CSV file to write [DIR/derived.csv]")->type_name("FILE");
  command->add_flag("--quiet", args->solve.quiet, "print nothing but errors");
  command->callback([args, &exit_code] { exit_code = run_derive_command(*args); });
}

}  // namespace moiregauge::internal::cli
