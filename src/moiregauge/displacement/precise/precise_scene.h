// SPDX-License-Identifier: Apache-2.0
// Scene of one run, solved from its frames. The solution includes the tests for a moving reference, a rolling shutter
// and print errors.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/calibration/model/print_error.h"
#include "moiregauge/calibration/model/rolling_shutter.h"
#include "moiregauge/calibration/model/target_movement.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/precise/apparent_size.h"
#include "moiregauge/displacement/smear_error.h"

namespace moiregauge::internal {

// chi2 per degree of freedom above which a rolling shutter is unexplained, if free rotation during readout would remove
// most of it. With a solved rolling shutter it is the limit of `untrusted`. Chosen.
inline constexpr double kRollingChi2 = 4.0;

struct PreciseScene {
  Calibration calibration;  // from the key frames, the reference frame first
  std::string problem;      // reason why the run cannot be measured in this scene
  // Rolling shutter that no camera path explains: no row of any method is trusted.
  bool rolls = false;

  // Frames without a moving reference and without the movements of targets beyond displacement, corrected to frame time.
  FrameSeries frames;
  std::shared_ptr<const MovementRemoval> movements;  // null if there are none
  FrameSeries with_movements;                        // `frames` before their removal
  std::optional<std::size_t> excluded;               // a reference that moves, not used in `frames`
  std::optional<Shutter> shutter;                    // solved rolling shutter
  SmearError smear;                                  // uneven movement within the exposures of `frames`
  PrintError print_error;                            // to be included in the covariance of `frames`
  std::vector<SizeDeviation> size_deviations;

  bool references_verified = false;
  bool doubtful = false;             // one of the references moves, and it is unknown which
  bool vibrates = false;             // the camera vibrates within the readout, by more than its rows show
  bool camera_contradicted = false;  // the footage contradicts the given camera
  bool height_contradicted = false;  // the footage contradicts the stated height of a target
  std::vector<std::string> notes;    // warnings for the user
  // Instruction if no row is trusted; empty if no remedy is known.
  std::string remedy;
};

// Solves the scene of a run.
// `read`: the reference frame first, with the codec's error if the footage is lossy.
// `lossy`: the footage has such an error.
// Fails (problem is not empty): no scene, or an unexplained rolling shutter.
[[nodiscard]] PreciseScene precise_scene(const Reference& reference, const FrameSeries& read, const ScenePrior& prior,
                                         const SolveOptions& options, bool lossy);

}  // namespace moiregauge::internal
