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
  std::size_t parameter = 0;  // index in the scene's camera: the most deviating one
  double given = 0.0, u_given = 0.0;
  double shown = 0.0, u_shown = 0.0;  // from the footage without the statement
  double error_u = 0.0;               // largest change of a displacement, in its u
};

// Tests a given camera by a likelihood ratio: the fall of chi2 if the camera is unknown, with everything else free in
// both cases. Returns the contradiction if the fall exceeds chance and a displacement changes by more than its u.
// `given`: prior with the camera as stated.
// `frames`: key frames, the reference frame first, as in `solved`.
[[nodiscard]] std::optional<CameraContradiction> camera_contradiction(const Site& site,
                                                                      std::span<const BundleFrame> frames,
                                                                      const ScenePrior& given,
                                                                      const Calibration& solved);

// Returns the warning with the most deviating parameter.
[[nodiscard]] std::string camera_contradiction_note(const CameraContradiction& found);

}  // namespace moiregauge::internal
