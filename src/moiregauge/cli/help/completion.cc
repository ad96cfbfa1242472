// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/completion.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/cli/help/command_list.h"
#include "moiregauge/cli/help/page.h"
#include "moiregauge/simulator/scenario/built_in.h"

namespace moiregauge::internal::cli {
namespace {

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

const CLI::Option* positional_of(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) return option;
  return nullptr;
}

// Returns one line of bash that fills COMPREPLY for a value.
std::string bash_reply(const ValueWords& value) {
  std::string kinds;
  if (value.files) kinds += " -f";
  if (value.folders) kinds += " -d";
  if (!value.words.empty()) kinds += fmt::format(" -W '{}'", fmt::join(value.words, " "));
  if (kinds.empty()) return "return";
  const char* names = value.files || value.folders ? "compopt -o filenames; " : "";
  return fmt::format("{}mapfile -t COMPREPLY < <(compgen{} -- \"$cur\"); return", names, kinds);
}

std::string bash_values(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional() || !takes_value(*option)) continue;
    std::string patterns;
    for (const std::string& name : names_of(*option))
      patterns += fmt::format("{}'{} {}'", patterns.empty() ? "" : "|", command.get_name(), name);
    text += fmt::format("    {}) {} ;;\n", patterns, bash_reply(value_words(*option)));
  }
  return text;
}

std::string bash_words(const CLI::App& command) {
  std::string names;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_positional())
      names += fmt::format("{}{}", names.empty() ? "" : " ", fmt::join(names_of(*option), " "));
  const CLI::Option* positional = positional_of(command);
  return fmt::format("    {}) options='{}'\n      [[ $cur == -* ]] || {{ {}; }} ;;\n", command.get_name(), names,
                     bash_reply(positional == nullptr ? ValueWords{} : value_words(*positional)));
}

// Escapes text for single quotes, and for zsh's [explanation] and name:message.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, text.find('\n'))) {
    if (c == '\'')
      out += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      out += fmt::format("\\{}", c);
    else
      out += c;
  }
  return out;
}

std::string zsh_action(const CLI::Option& option) {
  const ValueWords value = value_words(option);
  if (value.files && !value.words.empty())
    return fmt::format("_alternative \"words:word:({})\" \"files:file:_files\"", fmt::join(value.words, " "));
  if (value.files) return "_files";
  if (value.folders) return "_files -/";
  return value.words.empty() ? " " : fmt::format("({})", fmt::join(value.words, " "));
}

std::string zsh_option(const CLI::Option& option) {
  if (option.get_positional()) return fmt::format("      '*:{}:{}'", option.get_name(true), zsh_action(option));
  std::string text;
  for (const std::string& name : names_of(option)) {
    const std::string value =
        takes_value(option) ? fmt::format(":{}:{}", zsh_text(option.get_type_name()), zsh_action(option)) : "";
    text += fmt::format("{}      '*{}[{}]{}'", text.empty() ? "" : " \\\n", name, zsh_text(option.get_description()),
                        value);
  }
  return text;
}

}  // namespace

ValueWords value_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  ValueWords value;
  value.files = type == "FILE";
  value.folders = type == "DIR";
  const std::string positional = option.get_positional() ? option.get_name(true) : "";
  if (positional == "SCENARIO")
    for (const auto& entry : simulator::built_in_scenarios()) value.words.emplace_back(entry.name);
  if (positional == "COMMAND")
    for (const Page& page : pages()) value.words.emplace_back(page.name);
  for (std::size_t at = 0; type.find('|') != std::string::npos && at <= type.size();) {
    const auto end = std::min(type.find('|', at), type.size());
    value.words.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return value;
}

std::string bash_completion(const CLI::App& app) {
  std::string commands, values, words;
  for (const CLI::App* command : visible_commands(app)) {
    commands += command->get_name() + " ";
    values += bash_values(*command);
    words += bash_words(*command);
  }
  return fmt::format(R"(# bash completion for moiregauge: made by `moiregauge completion bash`
_moiregauge() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}} options=
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W '{}--help --version' -- "$cur")
    return
  fi
  case "$command $before" in
{}  esac
  case $command in
{}  esac
  mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
}}
complete -F _moiregauge moiregauge
)",
                     commands, values, words);
}

std::string zsh_completion(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : visible_commands(app)) {
    commands += fmt::format("    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    std::string options;
    for (const CLI::Option* option : command->get_options())
      options += fmt::format("{}{}", options.empty() ? "" : " \\\n", zsh_option(*option));
    cases += fmt::format("    {})\n      _arguments -s \\\n{} ;;\n", command->get_name(), options);
  }
  return fmt::format(R"(#compdef moiregauge
# zsh completion for moiregauge: made by `moiregauge completion zsh`
_moiregauge() {{
  local -a commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
_moiregauge "$@"
)",
                     commands, cases);
}

}  // namespace moiregauge::internal::cli
