// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/scenario_file.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/nearest_word.h"
#include "moiregauge/io/config/toml_table.h"
#include "moiregauge/io/config/toml_version.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/scenario/settings.h"

namespace moiregauge::internal {
namespace {

// One entry of the file: full name, value as text, position.
struct Entry {
  std::string name;
  std::string text;
  const toml::value* place;
};

std::string text_of(const toml::value& value) {
  if (value.is_string()) return string_in(value);
  if (value.is_boolean()) return value.as_boolean(std::nothrow) ? "true" : "false";
  if (const auto number = finite_number(value)) return fmt::format("{}", *number);
  if (!value.is_array()) return value.is_integer() || value.is_floating() ? "not finite" : "";
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

// Replaces the markers of the base by those of the file.
void read_scene_markers(const toml::value& list, simulator::Scenario& scenario, std::vector<Entry>& entries,
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

// Returns the rank in which an entry is applied. Gratings must exist before [grating] sets all of them. A marker's own
// values come last, and so do those of one kind of draw.
int turn_of(const Entry& entry) {
  if (entry.name.ends_with(".grating_mm")) return 0;
  const bool is_for_several = entry.name.starts_with("grating.") || entry.name.starts_with("ink.") ||
                              entry.name == "truth.draw_known_to" || entry.name == "site.surveyed";
  return is_for_several ? 1 : 2;
}

// Settings of a scenario by name. The scenario must keep its markers meanwhile.
class Settings {
 public:
  explicit Settings(simulator::Scenario& scenario) {
    for (auto& setting : simulator::settings_of(scenario)) by_name_.try_emplace(setting.name, std::move(setting));
  }
  [[nodiscard]] std::optional<std::string> problem_applying(const std::string& name, const std::string& text) const {
    if (const auto found = by_name_.find(name); found != by_name_.end()) {
      const simulator::Setting& setting = found->second;
      return setting.set(text) ? std::nullopt : std::optional(fmt::format("{} must be {}", name, setting.kind));
    }
    std::vector<std::string_view> names;
    for (const auto& [known, setting] : by_name_) names.push_back(known);
    const auto nearest = nearest_word(name, names);
    return fmt::format("the key \"{}\" is unknown{}", name,
                       nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : "");
  }

 private:
  std::map<std::string, simulator::Setting> by_name_;
};

std::optional<simulator::Scenario> base_of(const toml::value& file, TomlMistakes& wrong) {
  const TomlTable table(file, wrong);
  const auto name = table.text("base");
  if (!name) return simulator::Scenario{};
  auto base = simulator::built_in(*name);
  if (!base)
    table.mistake("base",
                  fmt::format("the built-in scenario \"{}\" does not exist, see moiregauge simulate --list", *name));
  return base;
}

bool is_word_of(const std::string& text, const std::string& word) {
  const auto is_letter = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if ((at == 0 || !is_letter(at - 1)) && !is_letter(at + word.size())) return true;
  }
  return false;
}

// Returns the entry that a problem refers to. The problem contains either its full name, or the last part of its name
// and the name of its marker.
std::vector<Entry>::iterator spoken_of(const std::string& problem, std::vector<Entry>& entries) {
  const auto named =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return is_word_of(problem, entry.name); });
  if (named != entries.end()) return named;
  return std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) {
    const std::size_t dot = entry.name.rfind('.');
    if (!is_word_of(problem, entry.name.substr(dot == std::string::npos ? 0 : dot + 1))) return false;
    if (!entry.name.starts_with("marker.")) return true;
    const std::string rest = entry.name.substr(7);
    return is_word_of(problem, rest.substr(0, rest.find('.')));
  });
}

// Largest number of mistakes listed (chosen). Each needs a pass over the file, so a file made to hold thousands would
// take hours.
constexpr int kMaxMistakes = 20;

// Applies all valid entries. Adds a mistake for each of the others, and removes it.
void apply(std::vector<Entry>& entries, simulator::Scenario& scenario, TomlMistakes& wrong) {
  const Settings settings(scenario);
  int mistakes = 0;
  std::erase_if(entries, [&](const Entry& entry) {
    const auto problem = mistakes < kMaxMistakes ? settings.problem_applying(entry.name, entry.text) : std::nullopt;
    if (!problem) return false;
    wrong.add_at(*entry.place, *problem);
    ++mistakes;
    return true;
  });
}

// Finds values that are well formed but impossible, each at its entry. Removes the entry that causes a problem and
// checks again, to find the next one. A problem without an entry is reported only if it is the only one.
void note_senseless(const simulator::Scenario& unset, std::vector<Entry> entries, TomlMistakes& wrong) {
  for (int mistakes = 0; mistakes < kMaxMistakes; ++mistakes) {
    simulator::Scenario scenario = unset;
    apply(entries, scenario, wrong);
    const auto problem = simulator::problem_with(scenario);
    if (!problem) return;
    const auto entry = spoken_of(*problem, entries);
    if (entry == entries.end()) {
      if (wrong.empty()) wrong.add(1, 1, *problem);
      return;
    }
    wrong.add_at(*entry->place, *problem);
    entries.erase(entry);
  }
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
    read_scene_markers(*markers, *scenario, entries, wrong);
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return turn_of(a) < turn_of(b); });
  const simulator::Scenario unset = *scenario;
  apply(entries, *scenario, wrong);
  if (simulator::problem_with(*scenario)) note_senseless(unset, std::move(entries), wrong);
  if (!wrong.empty()) return tl::unexpected(wrong.lines());
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
    return tl::unexpected(fmt::format("\"{}\" has no \"=\", write KEY=VALUE", assignment));
  const Settings settings(scenario);
  if (auto problem = settings.problem_applying(assignment.substr(0, equals), assignment.substr(equals + 1)))
    return tl::unexpected(*std::move(problem));
  return {};
}

}  // namespace moiregauge::internal
