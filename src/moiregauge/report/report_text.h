// SPDX-License-Identifier: Apache-2.0
// The run in plain words.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/results/camera_motion.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// 95 % of a normal distribution.
inline constexpr double kCover95 = 1.96;

struct WordedRun {
  const Measurement& measurement;
  const MeasureOptions& options;
  const CameraMotion& camera;
};

// One or two sentences for each: the targets, how they vibrate, the camera, the lens, the rows.
struct Words {
  std::string outcome;  // "Measured", "Measured with gaps", "Not measured", "Stopped before its end"
  std::vector<std::string> summary;
  std::vector<std::string> advice;  // what to do about what went wrong; empty when nothing did
};
[[nodiscard]] Words words_of(const WordedRun& run);

// A status in a sentence, and what helps.
struct StatusWords {
  const char* meaning;
  const char* help;
};
[[nodiscard]] StatusWords words_of(Status status);

// A value with its 95 % interval, no more digits than that deserves: "2.0000 mm up (± 0.0012 mm)".
[[nodiscard]] std::string with_interval(double value_mm, double u_mm, const char* above, const char* below);

}  // namespace moiregauge::internal
