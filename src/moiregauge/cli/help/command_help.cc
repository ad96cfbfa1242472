// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/command_help.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/nearest_word.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/help/page.h"

namespace moiregauge::internal::cli {
namespace {

struct HelpWords {
  std::string command = "moiregauge";
  bool man = false;
};

// Columns. Longer lines are tiring to read on any terminal (chosen).
constexpr std::size_t kWidest = 100;

std::size_t width_of_terminal() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 40) return kWidest;
  return std::min<std::size_t>(size.ws_col, kWidest);
}

int no_such_page(const std::string& word) {
  std::vector<std::string_view> known;
  for (const Page& page : pages()) known.push_back(page.name);
  const auto nearest = nearest_word(word, known);
  return fail(Exit::kUsage, fmt::format("the page does not exist: help {}: {}", word,
                                        nearest ? fmt::format("did you mean moiregauge help {}?", *nearest)
                                                : "list the commands with moiregauge help"));
}

int run(const HelpWords& words, const CLI::App& app) {
  if (page_named(words.command) == nullptr) return no_such_page(words.command);
  if (!words.man) {
    show_page(words.command);
    return 0;
  }
  const auto commands = app.get_subcommands([&](const CLI::App* c) { return c->get_name() == words.command; });
  print_out(page_man(words.command, (commands.empty() ? &app : commands.front())->get_description()));
  return 0;
}

}  // namespace

void show_page(std::string_view name) { print_out(page_text(name, width_of_terminal())); }

void add_help(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("help", "Show the page of a command, or the first steps");
  const auto words = std::make_shared<HelpWords>();
  command->add_option("COMMAND", words->command, "command to explain [the whole program]")->type_name("NAME");
  command->add_flag("--man", words->man, "print a man page: moiregauge help --man measure | man -l -");
  command->callback([words, &app, &exit_code] { exit_code = run(*words, app); });
}

}  // namespace moiregauge::internal::cli
