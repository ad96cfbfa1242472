// SPDX-License-Identifier: Apache-2.0
// Collects the settings of a scenario: one call per value, by its kind.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/simulator/scenario/settings.h"

namespace moiregauge::internal::simulator {

// Reads numbers from "[[0, 1], [2, 3]]" or "0 1 2 3". Empty if a word is no finite number.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string text);
[[nodiscard]] std::optional<double> number_in(const std::string& text);

class Collector {
 public:
  std::vector<Setting> settings;

  void number(const std::string& name, double& value);
  void number(const std::string& name, const std::function<void(double)>& take);
  template <typename Whole>
  void whole(const std::string& name, Whole& value) {
    text(name, "a whole number of 0 or more", [&value](const std::string& words) {
      const auto read = number_in(words);
      if (!read || *read < 0.0 || *read > 2e9 || *read != std::floor(*read)) return false;
      value = static_cast<Whole>(*read);
      return true;
    });
  }
  void flag(const std::string& name, const std::vector<bool*>& values);
  void pair(const std::string& name, const std::function<void(double, double)>& take);
  void text(const std::string& name, const std::string& kind, std::function<bool(const std::string&)> take);
  void frames(const std::string& name, std::vector<FrameSpan>& spans);
  // Adds all values of a track. The bare name sets its offset.
  void track(const std::string& name, Track& track);
};

// Adds the settings of faults in the scene, the camera and the site (settings_faults.cc).
void add_faults(Collector& all, Scenario& scenario);
void add_faults_of(Collector& all, SceneMarker& marker);

}  // namespace moiregauge::internal::simulator
