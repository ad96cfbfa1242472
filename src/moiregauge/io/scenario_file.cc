// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/scenario_file.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/io/nearest_word.h"
#include "moiregauge/io/toml_table.h"
#include "moiregauge/simulator/built_in.h"
#include "moiregauge/simulator/settings.h"

namespace moiregauge {
namespace {

// One line of the file: its full name, its value as text, its place.
struct Entry {
  std::string name;
  std::string text;
  const toml::value* place;
};

std::string text_of(const toml::value& value) {
  if (value.is_string()) return value.as_string(std::nothrow).str;
  if (value.is_boolean()) return value.as_boolean(std::nothrow) ? "true" : "false";
  if (value.is_integer()) return fmt::format("{}", value.as_integer(std::nothrow));
  if (value.is_floating()) return fmt::format("{}", value.as_floating(std::nothrow));
  if (!value.is_array()) return "";
  std::string text;
  for (const toml::value& part : value.as_array(std::nothrow)) text += text_of(part) + " ";
  return text;
}

void flatten(const toml::value& table, const std::string& prefix, std::vector<Entry>& entries) {
  for (const auto& [key, value] : table.as_table()) {
    if (value.is_table()) {
      flatten(value, prefix + key + ".", entries);
    } else {
      entries.push_back({prefix + key, text_of(value), &value});
    }
  }
}

// The markers of the file take the place of the base's.
void read_markers(const toml::value& list, simulator::Scenario& scenario, std::vector<Entry>& entries,
                  TomlMistakes& wrong) {
  if (!list.is_array()) return wrong.add_at(list, "marker must be written as [[marker]]");
  scenario.markers.clear();
  for (const toml::value& marker : list.as_array(std::nothrow)) {
    if (!marker.is_table()) return wrong.add_at(list, "marker must be written as [[marker]]");
    const auto name = TomlTable(marker, wrong).text("name");
    if (!name || name->empty()) {
      wrong.add_at(marker, "a marker needs a name");
      continue;
    }
    scenario.markers.emplace_back().print.name = *name;
    std::vector<Entry> own;
    flatten(marker, "marker." + *name + ".", own);
    std::erase_if(own, [&](const Entry& entry) { return entry.name == "marker." + *name + ".name"; });
    entries.insert(entries.end(), own.begin(), own.end());
  }
}

// Gratings must be there before [grating] speaks of all of them, and a marker's own word is the last; so is that of one
// kind of draw.
int turn_of(const Entry& entry) {
  if (entry.name.ends_with(".grating_mm")) return 0;
  return entry.name.starts_with("grating.") || entry.name == "truth.draw_known_to" ? 1 : 2;
}

std::optional<std::string> problem_applying(simulator::Scenario& scenario, const std::string& name,
                                            const std::string& text) {
  const auto settings = simulator::settings_of(scenario);
  std::vector<std::string_view> names;
  for (const auto& setting : settings) {
    if (setting.name == name) {
      return setting.set(text) ? std::nullopt : std::optional(fmt::format("{} must be {}", name, setting.kind));
    }
    names.push_back(setting.name);
  }
  const auto nearest = nearest_word(name, names);
  return fmt::format("unknown key \"{}\"{}", name, nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : "");
}

std::optional<simulator::Scenario> base_of(const toml::value& file, TomlMistakes& wrong) {
  const TomlTable table(file, wrong);
  const auto name = table.text("base");
  if (!name) return simulator::Scenario{};
  auto base = simulator::built_in(*name);
  if (!base)
    table.mistake("base", fmt::format("there is no built-in scenario \"{}\"; see moiregauge simulate --list", *name));
  return base;
}

}  // namespace

tl::expected<simulator::Scenario, std::vector<std::string>> parse_scenario(const std::string& text,
                                                                           const std::string& path) {
  const auto file = parse_toml(text, path);
  if (!file) return tl::unexpected(std::vector{file.error()});
  TomlMistakes wrong(path);
  auto scenario = base_of(*file, wrong);
  if (!scenario) return tl::unexpected(wrong.lines());
  scenario->name = path;
  std::vector<Entry> entries;
  flatten(*file, "", entries);
  std::erase_if(entries, [](const Entry& entry) { return entry.name == "base" || entry.name == "marker"; });
  if (const toml::value* markers = TomlTable(*file, wrong).find("marker"))
    read_markers(*markers, *scenario, entries, wrong);
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return turn_of(a) < turn_of(b); });
  for (const Entry& entry : entries) {
    if (const auto problem = problem_applying(*scenario, entry.name, entry.text)) wrong.add_at(*entry.place, *problem);
  }
  if (!wrong.empty()) return tl::unexpected(wrong.lines());
  if (const auto problem = simulator::problem_with(*scenario)) {
    return tl::unexpected(std::vector{fmt::format("{}: {}", path, *problem)});
  }
  return *std::move(scenario);
}

tl::expected<simulator::Scenario, std::vector<std::string>> read_scenario(const std::string& path) {
  const auto text = read_small_file(path, kTextFileLimit);
  if (!text) return tl::unexpected(std::vector{text.error()});
  return parse_scenario(*text, path);
}

tl::expected<void, std::string> apply_setting(simulator::Scenario& scenario, const std::string& assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos)
    return tl::unexpected(fmt::format("\"{}\" has no \"=\"; write KEY=VALUE", assignment));
  if (auto problem = problem_applying(scenario, assignment.substr(0, equals), assignment.substr(equals + 1))) {
    return tl::unexpected(*std::move(problem));
  }
  return {};
}

}  // namespace moiregauge
