// SPDX-License-Identifier: Apache-2.0
// Describes a run in sentences.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/results/camera_motion.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// coverage factor k of every U that is shown, for about 95 % of a normal distribution
inline constexpr double kCoverageFactor = 2.0;

struct WordedRun {
  const Measurement& measurement;
  const MeasureOptions& options;
  const CameraMotion& camera;
};

// Sentences on the targets, their vibration, camera, lens and samples.
struct Words {
  std::string outcome;  // "Measured", "Measured with gaps", "Not measured" or "Stopped early"
  std::vector<std::string> summary;
  std::vector<std::string> advice;  // remedies for problems; empty if there are none
};
[[nodiscard]] Words words_of(const WordedRun& run);

// Meaning of a status, and its remedy.
struct StatusWords {
  const char* meaning;
  const char* help;
};
[[nodiscard]] StatusWords words_of(Status status);

}  // namespace moiregauge::internal
