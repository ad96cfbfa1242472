// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/load_scenario.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/io/config/scenario_file.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "moiregauge/simulator/scenario/settings.h"

namespace moiregauge::internal {

tl::expected<simulator::Scenario, std::string> load_scenario(const ScenarioArgs& args) {
  simulator::Scenario scenario;
  if (auto known = simulator::built_in(args.scenario)) {
    scenario = *std::move(known);
  } else if (!std::filesystem::is_regular_file(args.scenario)) {
    return tl::unexpected(fmt::format(
        "the scenario does not exist: {}: give a TOML file or a name of moiregauge simulate --list", args.scenario));
  } else {
    auto read = read_scenario(args.scenario);
    if (!read)
      return tl::unexpected(mistakes_in("scenario", args.scenario, fmt::format("{}", fmt::join(read.error(), "\n"))));
    scenario = *std::move(read);
  }
  for (const std::string& setting : args.settings) {
    if (auto applied = apply_setting(scenario, setting); !applied) {
      return tl::unexpected(fmt::format("the setting is not valid: --set {}: {}", setting, applied.error()));
    }
  }
  if (args.seed) scenario.seed = *args.seed;
  if (args.frames) scenario.frames = *args.frames;
  if (auto problem = simulator::problem_with(scenario)) {
    return tl::unexpected(fmt::format("the scenario is not valid: {}: {}", args.scenario, *problem));
  }
  return scenario;
}

}  // namespace moiregauge::internal
