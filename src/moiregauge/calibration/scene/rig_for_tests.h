// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/site/site.h"

namespace moiregauge::internal::test {

inline constexpr double kPitch = 10.0;  // mm
inline constexpr double kNoise = 2e-4;  // pitches, for each coordinate of a point: 2 um, 0.006 px

// Four references and a target, laid out as on the paper's rig.
inline Site rig() {
  Site site;
  const auto add = [&](Role role, double x, double y, double size) {
    Marker m;
    m.role = role;
    m.name = std::to_string(site.markers.size());
    m.grating = Grating{{x, y}, size, size, kPitch, 0.0, Pattern::kGrid};
    site.markers.push_back(m);
  };
  for (const double y : {28.0, -28.0}) {
    for (const double x : {-340.0, 340.0}) add(Role::kReference, x, y, 40.0);
  }
  add(Role::kTarget, 0.0, 0.0, 60.0);
  return site;
}

}  // namespace moiregauge::internal::test
