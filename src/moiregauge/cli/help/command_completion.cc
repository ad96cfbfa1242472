// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/command_completion.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/help/completion.h"

namespace moiregauge::internal::cli {
namespace {

int run(const std::string& shell, const CLI::App& app) {
  if (shell != "bash" && shell != "zsh")
    return fail(Exit::kUsage, fmt::format("the shell is unknown: completion {}: choose one of bash, zsh", shell));
  print_out(shell == "bash" ? bash_completion(app) : zsh_completion(app));
  return 0;
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("completion", "Print the completion script for a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash or zsh")->type_name("bash|zsh")->required();
  command->group("");  // not listed in the help
  command->callback([shell, &app, &exit_code] { exit_code = run(*shell, app); });
}

}  // namespace moiregauge::internal::cli
