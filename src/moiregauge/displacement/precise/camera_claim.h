// SPDX-License-Identifier: Apache-2.0
// Tests a given camera (`--camera`) against the footage it is used for.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"

namespace moiregauge::internal {

// A camera that the references contradict.
struct CameraContradiction {
  std::size_t parameter = 0;  // of the scene's camera: the one that is furthest off
  double given = 0.0, u_given = 0.0;
  double shown = 0.0, u_shown = 0.0;  // by the footage without the statement
  double error_u = 0.0;               // by how many u displacements would be off at most
};

// Returns the contradiction if one is there and matters: chi2 of the frames falls by more than chance has it when the
// camera is unknown instead of known as stated (likelihood ratio, everything else free in both), and a displacement
// changes by more than its u.
// given   with the camera as it was stated
// frames  key frames, the reference frame first, as `solved` has them
[[nodiscard]] std::optional<CameraContradiction> camera_contradiction(const Site& site,
                                                                      std::span<const BundleFrame> frames,
                                                                      const ScenePrior& given,
                                                                      const Calibration& solved);

// "the footage contradicts --camera: ..."
[[nodiscard]] std::string camera_contradiction_note(const CameraContradiction& found);

}  // namespace moiregauge::internal
