// SPDX-License-Identifier: Apache-2.0
// Test scene: one grating in the middle of a small image, upright.
#pragma once

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::simulator {

inline constexpr double kPitch_mm = 6.0;

inline Scenario lines(Pattern pattern) {
  Scenario scenario;
  scenario.camera = {.width = 160, .height = 120, .cx = 80.2, .cy = 60.0};
  SceneMarker marker;
  marker.print.name = "mid";
  marker.print.role = Role::kTarget;
  marker.print.grating =
      Grating{.centre = {0.0, 0.0}, .width_mm = 30.0, .height_mm = 20.0, .pitch_mm = kPitch_mm, .pattern = pattern};
  marker.paper_margin_mm = 4.0;
  scenario.markers.push_back(marker);
  return scenario;
}

inline double px_per_mm(const Scenario& scenario) { return scenario.camera.fx / scenario.mount.distance_mm; }
inline double pitch_px(const Scenario& scenario) { return kPitch_mm * px_per_mm(scenario); }

}  // namespace moiregauge::internal::simulator
