// SPDX-License-Identifier: Apache-2.0
// Reference frame of four references and a target, as read by sampling moire.
#pragma once

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal::test {

inline constexpr double kA = 380.0, kB = 28.0;  // mm, the rig's circles
inline constexpr double kPitch_mm = 10.0, kPhase_rad = 0.002, kMmPerPx = 0.5;

inline Marker marker_with(Role role, BoardPoint at, Pattern pattern) {
  Marker m;
  m.role = role;
  if (role == Role::kReference) m.circle = Circle{at, 20.0};
  m.grating = Grating{at, 40.0, 40.0, kPitch_mm, 0.0, pattern};
  return m;
}

// Four references at (+-a, +-b) and a target in their middle. All gratings are read with the same phase noise.
inline Reference five_markers(Pattern of_target) {
  Reference reference;
  for (const BoardPoint at : {BoardPoint{-kA, kB}, {kA, kB}, {-kA, -kB}, {kA, -kB}})
    reference.site.markers.push_back(marker_with(Role::kReference, at, Pattern::kGrid));
  reference.site.markers.push_back(marker_with(Role::kTarget, {0.0, 0.0}, of_target));
  reference.view.ideal_from_board = IdealFromBoard(Eigen::Vector3d(1.0 / kMmPerPx, -1.0 / kMmPerPx, 1.0).asDiagonal());
  for (std::size_t i = 0; i < 5; ++i) {
    const Marker& m = reference.site.markers[i];
    if (m.circle) reference.circles.push_back({i, m.circle->centre, {}, 0.01});
    reference.plans.push_back(*plan_raster(*m.grating, kMmPerPx, {}));
    MarkerObservation seen;
    seen.patch.valid = true;
    seen.patch.u_phase_rad = {kPhase_rad, kPhase_rad};
    seen.patch.modulation = {60.0, 60.0};
    seen.patch.noise_sigma = 1.5;
    reference.seen.markers.push_back(seen);
  }
  return reference;
}

}  // namespace moiregauge::internal::test
