// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/commands.h"

#include <fmt/format.h>

#include "moiregauge/cli/batch/command_batch.h"
#include "moiregauge/cli/help/command_completion.h"
#include "moiregauge/cli/help/command_help.h"
#include "moiregauge/cli/help/command_list.h"
#include "moiregauge/cli/live/command_live.h"
#include "moiregauge/cli/measure/command_compare.h"
#include "moiregauge/cli/measure/command_derive.h"
#include "moiregauge/cli/measure/command_export.h"
#include "moiregauge/cli/measure/command_inspect.h"
#include "moiregauge/cli/measure/command_measure.h"
#include "moiregauge/cli/measure/command_solve.h"
#include "moiregauge/cli/plan/command_calibrate.h"
#include "moiregauge/cli/plan/command_plan.h"
#include "moiregauge/cli/plan/command_sheet.h"
#include "moiregauge/cli/reproduce/command_reproduce.h"
#include "moiregauge/cli/reproduce/command_simulate.h"
#include "moiregauge/cli/serve/command_serve.h"
#include "moiregauge/version.h"

namespace moiregauge::internal::cli {

namespace {

// A script's unset variable must not count as an option that was not given.
void refuse_empty_values(CLI::App& command) {
  const CLI::Validator is_given([](std::string& value) { return value.empty() ? std::string(kEmptyValue) : ""; }, "");
  for (CLI::Option* option : command.get_options()) {
    if (option->get_items_expected_max() > 0) option->transform(is_given);  // before every other check
  }
}

}  // namespace

std::unique_ptr<CLI::App> command_tree(int& exit_code) {
  auto tree = std::make_unique<CLI::App>(
      "moiregauge: displacement in millimetres from a video of printed gratings; the camera may move");
  CLI::App& app = *tree;
  app.name("moiregauge");
  app.set_help_flag("-h", "list the options");
  app.set_help_all_flag("--help", "show the whole page");
  app.set_version_flag("--version", kVersion, "print the version of the program");
  app.add_flag_callback(
      "--self-test", [] { throw CallForSelfTest(); }, "measure a simulated video and report whether it is right");
  app.require_subcommand(1);
  app.footer("For the page of one command: moiregauge help COMMAND");
  add_measure(app, exit_code);
  add_live(app, exit_code);
  add_serve(app, exit_code);
  add_batch(app, exit_code);
  add_solve(app, exit_code);
  add_derive(app, exit_code);
  add_compare(app, exit_code);
  add_export(app, exit_code);
  add_inspect(app, exit_code);
  add_calibrate(app, exit_code);
  add_plan(app, exit_code);
  add_sheet(app, exit_code);
  add_simulate(app, exit_code);
  add_reproduce(app, exit_code);
  add_help(app, exit_code);
  add_completion(app, exit_code);
  for (CLI::App* command : app.get_subcommands({})) {
    command->footer(fmt::format("For the whole page: moiregauge help {}", command->get_name()));
    refuse_empty_values(*command);
  }
  return tree;
}

}  // namespace moiregauge::internal::cli
