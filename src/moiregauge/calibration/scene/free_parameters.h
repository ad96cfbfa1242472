// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Which parameters a model solves; the others stay at their prior values. Without a lens f, cx and cy would only bend
// to its absence: they are solved together. The stretch of prints has a prior of its own, and costs nothing else.
[[nodiscard]] constexpr std::array<bool, kCommonParameters> free_common(const SceneModel& m) {
  return {m.radial, m.radial, m.radial, m.radial, m.radial, m.tangential, m.tangential, false, true};
}
// A target's place has a prior, and so is solved, only where frames are known in which it rests.
[[nodiscard]] constexpr std::array<bool, MarkerShape::kParameters> free_shape(const SceneModel& m, Role role) {
  const bool reference = role == Role::kReference;
  return {true, true, true, true, reference ? m.heights : m.depth};
}

}  // namespace moiregauge::internal
