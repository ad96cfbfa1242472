// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/usage.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/nearest_word.h"
#include "moiregauge/cli/help/command_list.h"

namespace moiregauge::internal::cli {
namespace {

struct Step {
  std::string_view command;
  std::string_view words;
  std::string_view what;
};

constexpr std::array kSteps{
    Step{"plan", "--distance 5m --camera phone-4k", "predict the uncertainty of a set-up"},
    Step{"sheet", "", "make marker sheets to print"},
    Step{"inspect", "clip.mp4 --pitch 10mm", "show the markers found in one frame"},
    Step{"measure", "clip.mp4 --pitch 10mm", "measure displacement, into the folder clip-moiregauge"},
    Step{"serve", "", "do all this in a web browser, for the clips of this folder"},
    Step{"simulate", "small-1xyz", "no clip yet: make one with known truth"},
};

bool is_option(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

std::string without_dashes(const std::string& word) {
  const auto begin = word.find_first_not_of('-');
  return begin == std::string::npos ? "" : word.substr(begin, word.find('=') - begin);
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
  std::vector<std::string_view> known;
  for (const CLI::Option* option : command.get_options())
    known.insert(known.end(), option->get_lnames().begin(), option->get_lnames().end());
  const auto nearest = nearest_word(without_dashes(word), known);
  return fmt::format("the option is unknown: {} {}: {}", command.get_name(), word.substr(0, word.find('=')),
                     nearest ? fmt::format("did you mean --{}?", *nearest)
                             : fmt::format("list the options with moiregauge {} -h", command.get_name()));
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string_view> known;
  for (const CLI::App* command : visible_commands(app)) known.emplace_back(command->get_name());
  const auto nearest = nearest_word(word, known);
  return fmt::format(
      "the command is unknown: {}: {}", word,
      nearest ? fmt::format("did you mean moiregauge {}?", *nearest) : "list the commands with moiregauge -h");
}

// Returns the command with its required arguments: "moiregauge calibrate PHOTOS --pitch LENGTH".
std::string required_text(const CLI::App& command) {
  std::string words = "moiregauge " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_required()) continue;
    words += " " + option->get_name(option->get_positional());
    if (!option->get_positional()) words += " " + option->get_type_name();
  }
  return words;
}

// Returns the part after the last ": ", which is CLI11's option and value.
std::string subject_of(const std::string& text) {
  const auto colon = text.rfind(": ");
  return colon == std::string::npos ? text : text.substr(colon + 2);
}

std::string mistake_in(const CLI::App& command, const CLI::ParseError& error) {
  const std::string& name = command.get_name();
  const auto left_over = command.remaining();
  if (const auto option = std::find_if(left_over.begin(), left_over.end(), is_option); option != left_over.end())
    return unknown_option(command, *option);
  if (!left_over.empty())
    return fmt::format(
        "one argument is too many: {} {}: remove it, or put its option before it (moiregauge {} -h lists them)", name,
        left_over.front(), name);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    return fmt::format("an argument is missing: {} ({}): write {}", name, error.what(), required_text(command));
  const std::string_view text = error.what();
  const std::string_view option = text.substr(0, text.find(':'));
  if (text.ends_with(kEmptyValue))
    return fmt::format("the value is empty: {} {}: give a value, or remove the option", name, option);
  if (text.find(": At Most 1 required") != std::string_view::npos)
    return fmt::format("the option is given twice: {} {}: give it once", name, option);
  if (text.find(": 1 required ") != std::string_view::npos)
    return fmt::format("the value is missing: {} {}: give a value, or remove the option", name, option);
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
    return fmt::format("the value is not a usable number: {} {}: give a number (moiregauge {} -h explains it)", name,
                       subject_of(error.what()), name);
  return fmt::format("the command cannot be understood: {} {}: see moiregauge {} -h", name, error.what(), name);
}

}  // namespace

std::string first_text(const CLI::App& app) {
  std::string text = app.get_description() + "\n\n";
  for (const Step& step : kSteps) {
    const auto commands = visible_commands(app);
    const bool is_there = std::any_of(commands.begin(), commands.end(),
                                      [&](const CLI::App* command) { return command->get_name() == step.command; });
    if (!is_there) continue;
    const std::string line = fmt::format("moiregauge {} {}", step.command, step.words);
    text += fmt::format("  {:<48} {}\n", line, step.what);
  }
  return text + "\nAll commands: moiregauge -h\nThe page of one command: moiregauge help measure\n";
}

std::string usage_mistake(const CLI::App& app, const CLI::ParseError& error) {
  const auto left_over = app.remaining();
  const auto commands = app.get_subcommands();
  if (commands.empty() && left_over.empty())
    return "a command is missing: moiregauge: list the commands with moiregauge -h";
  if (commands.empty() && !is_option(left_over.front())) return unknown_command(app, left_over.front());
  if (!left_over.empty())
    return fmt::format(
        "the option comes before its command: {}: put it after the command (moiregauge {} -h lists them)",
        left_over.front(), commands.empty() ? "measure" : commands.front()->get_name());
  return mistake_in(*commands.front(), error);
}

}  // namespace moiregauge::internal::cli
