// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_solve.h"

#include <memory>
#include <string>

#include "moiregauge/app/solve_run.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/json_progress.h"
#include "moiregauge/cli/common/shared_options.h"
#include "moiregauge/cli/common/stage_display.h"
#include "moiregauge/cli/measure/summary_text.h"

namespace moiregauge::internal::cli {
namespace {

tl::expected<SolvedResults, RunFailure> run_shown(const SolveArgs& args, const std::string& progress) {
  if (!progress.empty()) {
    JsonProgress lines(JsonProgress::Samples::kNone);
    return run_solve(args, lines.callbacks());
  }
  StageDisplay display(args.quiet);
  return run_solve(args, display.callbacks());
}

int run(const SolveArgs& args, const std::string& progress) {
  const auto solved = run_shown(args, progress);
  if (!solved) return fail(solved.error().exit, solved.error().message);
  return report(solved->measurement, solved->options, {args.run, solved->folder, args.quiet, args.json});
}

}  // namespace

void add_solve(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("solve", "Compute new results from a finished run, without its video");
  auto args = std::make_shared<SolveArgs>();
  command->add_option("DIR", args->run, "folder that `measure` wrote")->type_name("DIR")->required();
  command->add_option("--site", args->site, "site.toml with better positions, rotations, heights or known_to")
      ->type_name("FILE");
  command->add_option("--camera", args->camera, "calibrated camera, our TOML or OpenCV/ROS YAML")->type_name("FILE");
  command
      ->add_option("--rest", args->rest,
                   "frames in which no target moves, half open: A:B, or seconds, e.g. 0s:2s; none: ignore those of the "
                   "run")
      ->type_name("A:B|none");
  command->add_option("--fps", args->fps, "frames per second, for a run without times")->type_name("N");
  add_slow_motion(*command, args->slow_motion);
  command
      ->add_option("--zero", args->zero,
                   "zero is the mean over these ok frames, half open: A:B; none: the reference frame alone")
      ->type_name("A:B|none");
  command->add_option("--readout", args->readout, "rolling shutter: readout time from first to last row, e.g. 18ms")
      ->type_name("TIME");
  add_print_scale(*command, args->print_scale);
  add_marker_choice(*command, args->choice);
  command->add_option("--method", args->method, "two-stage, for a run measured by precise [the run's own]")
      ->type_name("two-stage|precise|conventional");
  command->add_option("-o,--out", args->output, "output folder [DIR: its results are replaced]")->type_name("DIR");
  add_figures(*command, args->figures);
  command->add_flag("--quiet", args->quiet, "print nothing but errors");
  command->add_flag("--json", args->json, "print run.json on stdout");
  const auto progress = std::make_shared<std::string>();
  add_progress(*command, *progress);
  command->callback([args, progress, &exit_code] { exit_code = run(*args, *progress); });
}

}  // namespace moiregauge::internal::cli
