// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Returns which of the shared parameters a model solves. The others keep their prior values.
// Without a lens f, cx and cy would bend to compensate its absence, so they are solved together with it. The stretch is
// always free: it has its own prior.
[[nodiscard]] constexpr std::array<bool, kCommonParameters> free_common(const SceneModel& m) {
  return {m.radial, m.radial, m.radial, m.radial, m.radial, m.tangential, m.tangential, false, true};
}
// Returns which parameters of a marker a model solves. A target's position has a prior only with rest frames. Otherwise
// its u is 0 and it stays fixed.
[[nodiscard]] constexpr std::array<bool, MarkerShape::kParameters> free_shape(const SceneModel& m, Role role) {
  const bool reference = role == Role::kReference;
  return {true, true, true, true, reference ? m.heights : m.depth, m.tilts, m.tilts};
}

}  // namespace moiregauge::internal
